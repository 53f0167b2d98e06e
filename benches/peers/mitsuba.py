"""Measures Twinlight against Mitsuba 3 on the same scenes; benches/peers/run sets up what this needs and calls it.

A folder holds NAME.json and, beside it or under --references, NAME.exr, a converged image of it. Every scene is rendered by
all configurations in turn, as often as --repetitions says, each time with another seed and another one first, so that a
machine's drift hits all alike. What Mitsuba cannot render exactly as it stands is told and left out.

relMSE      mean((x - ref)^2 / (ref^2 + 0.01)) less the reference's own (--noise)
CPU s       Twinlight: of the whole process, by the system's account: starting, reading the scene and writing the image
            included. Mitsuba: of its process during a render alone, after one with another seed has compiled its kernels
efficiency  1 / (relMSE x CPU s)
ratio       efficiency over that of the peer with the highest median: the median over the repetitions of the ratio of runs
            made together
energy      mean over the reference's, of all repetitions together
agrees      whether the mean of all repetitions differs from the reference by no more than noise: squared differences of the
            means of blocks of 16 x 16 pixels, over what the spread between the repetitions and --noise explain. About 1
            where the images agree; from 2 on they do not
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

# This file is named like the package that it imports: its folder must not be where that is looked for.
HERE = str(Path(__file__).resolve().parent)
sys.path[:] = [entry for entry in sys.path if Path(entry or ".").resolve() != Path(HERE)]
try:
    import drjit as dr
    import mitsuba as mi
    import numpy as np
except ImportError as error:
    sys.exit(f"peers: error: {error}. Start this by benches/peers/run, which installs what it needs.")
sys.path.append(HERE)
from scene import Converter, Unconvertible

VARIANT = "llvm_ad_rgb"
BLOCK = 16


def warn(text):
    print(f"peers: {text}", file=sys.stderr, flush=True)


def options():
    parser = argparse.ArgumentParser(
        prog="benches/peers/run", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="with NAME.json, and NAME.exr if there is no --references")
    parser.add_argument("--references", type=Path, metavar="DIR", help="where NAME.exr are [FOLDER]")
    parser.add_argument("--scenes", metavar="NAME,...", help="these alone [all with a reference]")
    parser.add_argument("--noise", action="append", default=[], metavar="NAME=VALUE",
                        help="relMSE of a scene's reference, which is subtracted; for each scene")
    parser.add_argument("--twinlight", type=Path, default=Path("target/release/twinlight"), metavar="FILE",
                        help="the binary [target/release/twinlight]")
    parser.add_argument("--integrators", default="auto,bdpt,path", metavar="LIST", help="Twinlight's [auto,bdpt,path]")
    parser.add_argument("--peers", default="path,ptracer", metavar="LIST", help="Mitsuba's [path,ptracer]")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel [64]")
    parser.add_argument("--repetitions", type=int, default=3, metavar="N", help="[3]")
    parser.add_argument("--first-seed", type=int, default=1001, metavar="N", help="[1001]")
    parser.add_argument("--threads", type=int, default=2, metavar="N", help="[2]")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every run as JSON")
    args = parser.parse_args()
    args.integrators = [name for name in args.integrators.split(",") if name]
    args.peers = [name for name in args.peers.split(",") if name]
    noise = {}
    for item in args.noise:
        name, _, value = item.partition("=")
        try:
            noise[name] = float(value)
        except ValueError:
            parser.error(f"--noise {item}: not NAME=VALUE")
    args.noise = noise
    if min(args.spp, args.repetitions, args.threads) < 1:
        parser.error("--spp, --repetitions and --threads are 1 or more")
    if unknown := set(args.peers) - {"path", "ptracer"}:
        parser.error(f"--peers: {', '.join(sorted(unknown))} is none of path, ptracer")
    if not args.twinlight.is_file():
        parser.error(f"--twinlight: there is no {args.twinlight}; cargo build --release makes it")
    return args


def read_exr(path):
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return np.array(bitmap, dtype=np.float64)


def rel_mse(image, reference):
    return float(np.mean((image - reference) ** 2 / (reference**2 + 1e-2)))


def blocks(image):
    """Means of blocks; what is left over at the right and the bottom is left out."""
    height, width = (n // BLOCK * BLOCK for n in image.shape[:2])
    return image[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).mean(axis=(1, 3))


class Mitsuba:
    """One of Mitsuba's integrators on a loaded scene."""

    def __init__(self, name, scene, args):
        self.name, self.peer, self.scene, self.spp = f"Mitsuba {name}", True, scene, args.spp
        self.integrator = mi.load_dict({"type": name, "max_depth": -1, "rr_depth": 5})
        self.run(args.first_seed - 1)

    def run(self, seed):
        start = time.process_time()
        image = mi.render(self.scene, integrator=self.integrator, spp=self.spp, seed=seed)
        dr.eval(image)
        dr.sync_thread()
        seconds = time.process_time() - start
        return np.array(image, dtype=np.float64), seconds


class Twinlight:
    """One of Twinlight's integrators on a scene file."""

    def __init__(self, name, path, folder, args):
        self.name, self.peer = f"twinlight {name}", False
        self.image = folder / "image.exr"
        self.command = [str(args.twinlight), "render", str(path), "--integrator", name, "--spp", str(args.spp),
                        "--threads", str(args.threads), "-o", str(self.image), "--quiet"]

    def run(self, seed):
        child = subprocess.Popen([*self.command, "--seed", str(seed)])
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            sys.exit(f"peers: error: {' '.join(child.args)} ended with status {child.returncode}")
        return read_exr(self.image), usage.ru_utime + usage.ru_stime


def measure(name, path, reference, args):
    """All runs of a scene: its configurations, each with what its runs gave."""
    reference = read_exr(reference)
    noise = args.noise.get(name, 0.0)
    if name not in args.noise:
        warn(f"{name}: the reference's noise is not known (--noise {name}=VALUE): nothing is subtracted")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        configurations = [Twinlight(x, path, folder, args) for x in args.integrators]
        left_out = []
        converter = Converter(mi, folder)
        try:
            scene = mi.load_dict(converter.scene(json.loads(path.read_text())))
        except Unconvertible as reason:
            left_out.append(f"Mitsuba: cannot be converted: {reason}")
        else:
            for peer in args.peers:
                if peer == "ptracer" and converter.smooth:
                    left_out.append("Mitsuba ptracer: cannot see the smooth surfaces")
                else:
                    configurations.append(Mitsuba(peer, scene, args))
        for text in left_out:
            warn(f"{name}: {text}")
        runs = {c.name: [] for c in configurations}
        images = {c.name: [] for c in configurations}
        for repetition in range(args.repetitions):
            first = repetition % len(configurations)
            for c in configurations[first:] + configurations[:first]:
                seed = args.first_seed + repetition
                image, seconds = c.run(seed)
                if image.shape != reference.shape:
                    sys.exit(f"peers: error: {name}: the reference has {reference.shape[1]} x {reference.shape[0]} pixels, "
                             f"the image {image.shape[1]} x {image.shape[0]}")
                if not np.isfinite(image).all():
                    sys.exit(f"peers: error: {name}: {c.name} gave pixels that are not finite (seed {seed})")
                error = rel_mse(image, reference) - noise
                runs[c.name].append({"seed": seed, "cpu_seconds": seconds, "rel_mse": error if error > 0 else None,
                                     "efficiency": 1 / (error * seconds) if error > 0 else None})
                images[c.name].append(image)
    results = [
        {"name": c.name, "peer": c.peer, **agreement(images[c.name], reference, noise), "runs": runs[c.name]}
        for c in configurations
    ]
    rate(results)
    return {"scene": name, "reference_noise": noise, "left_out": left_out, "configurations": results}


def agreement(images, reference, noise):
    energy = float(np.mean(images) / reference.mean())
    if len(images) < 2:
        return {"energy": energy, "differs_by": None}
    means = np.array([blocks(image) for image in images])
    truth = blocks(reference)
    weight = 1 / (truth**2 + 1e-2)
    found = np.mean((means.mean(axis=0) - truth) ** 2 * weight)
    explained = np.mean(means.var(axis=0, ddof=1) / len(images) * weight) + noise / BLOCK**2
    return {"energy": energy, "differs_by": float(found / explained)}


def spread(values):
    """Median, least and greatest; None where one is below the reference's noise."""
    return None if None in values else [median(values), min(values), max(values)]


def rate(results):
    """Adds medians and ratios to the best peer."""
    for r in results:
        for key in ("rel_mse", "cpu_seconds", "efficiency"):
            r[key] = spread([run[key] for run in r["runs"]])
    peers = [r for r in results if r["peer"] and r["efficiency"]]
    best = max(peers, key=lambda r: r["efficiency"][0], default=None)
    for r in results:
        r["best_peer"] = r is best
        ratio = best and r["efficiency"] and [
            ours["efficiency"] / theirs["efficiency"] for ours, theirs in zip(r["runs"], best["runs"])]
        r["ratio"] = spread(ratio) if ratio else None


def show(values, format):
    if values is None:
        return "< noise"
    middle, least, most = (format % x for x in values)
    return f"{middle} ({least} … {most})"


def agrees(r):
    differs = r["differs_by"]
    if differs is None:
        return "one run only"
    return f"{'yes' if differs < 2 else 'NO'} ({differs:.2f})"


def table(results):
    lines = ["| scene | | relMSE | CPU s | efficiency | over the best peer | energy | agrees |",
             "|---|---|---|---|---|---|---|---|"]
    for scene in results:
        for r in scene["configurations"]:
            ratio = "best peer" if r["best_peer"] else show(r["ratio"], "%.2f") if r["ratio"] else "–"
            lines.append(f"| {scene['scene']} | {r['name']} | {show(r['rel_mse'], '%.2e')} | {show(r['cpu_seconds'], '%.2f')} "
                         f"| {show(r['efficiency'], '%.3g')} | {ratio} | {r['energy']:.4f} | {agrees(r)} |")
    return "\n".join(lines)


def main():
    args = options()
    try:
        mi.set_variant(VARIANT)
    except ImportError as error:
        sys.exit(f"peers: error: {error}\nStart this by benches/peers/run, which finds an LLVM, or set DRJIT_LIBLLVM_PATH.")
    dr.set_thread_count(args.threads)
    references = args.references or args.folder
    wanted = args.scenes.split(",") if args.scenes else [path.stem for path in sorted(args.folder.glob("*.json"))]
    results = []
    for name in wanted:
        path, reference = args.folder / f"{name}.json", references / f"{name}.exr"
        if missing := [p for p in (path, reference) if not p.is_file()]:
            warn(f"{name} is left out: there is no {missing[0]}")
            continue
        warn(f"{name} ...")
        results.append(measure(name, path, reference, args))
    if not results:
        sys.exit("peers: error: no scene to measure")
    print(table(results))
    for scene in results:
        for text in scene["left_out"]:
            print(f"\n{scene['scene']}: {text}")
    if args.json:
        version = subprocess.run([args.twinlight, "--version"], capture_output=True, text=True).stdout.strip()
        report = {"twinlight": version, "mitsuba": mi.__version__, "drjit": dr.__version__, "variant": VARIANT,
                  "python": platform.python_version(), "spp": args.spp, "threads": args.threads,
                  "repetitions": args.repetitions, "scenes": results}
        args.json.write_text(json.dumps(report, indent=1) + "\n")
    if disagreeing := [f"{s['scene']} by {r['name']}" for s in results for r in s["configurations"]
                       if r["differs_by"] is not None and r["differs_by"] >= 2]:
        sys.exit(f"peers: error: not the reference's image, so that the figures mean nothing: {', '.join(disagreeing)}")


if __name__ == "__main__":
    main()
