"""Converts Twinlight's native scenes (docs/SCENE_FORMAT.md) to Mitsuba dictionaries.

What has no exact counterpart in Mitsuba raises `Unconvertible`: a peer that renders another scene measures nothing.
"""

import numpy as np


class Unconvertible(Exception):
    """The scene holds what Mitsuba cannot render, or what this script does not convert."""


def colour(value):
    """A colour, three numbers or one, as Mitsuba's; not a texture."""
    if isinstance(value, (int, float)):
        value = [value] * 3
    if not isinstance(value, list) or len(value) != 3 or not all(isinstance(x, (int, float)) for x in value):
        raise Unconvertible(f"textures (a colour is {value!r})")
    return {"type": "rgb", "value": [float(x) for x in value]}


def only(thing, what, *keys):
    """Refuses keys that the conversion would not honour."""
    rest = sorted(set(thing) - set(keys) - {"type", "name"})
    if rest:
        raise Unconvertible(f"{what}: {', '.join(rest)}")


def unit(vector):
    vector = np.asarray(vector, float)
    return vector / np.linalg.norm(vector)


def frame(back, up):
    """Axes x, y, z as columns: z along `back`, y as near to `up` as may be."""
    z = unit(back)
    x = unit(np.cross(up, z))
    return np.column_stack([x, np.cross(z, x), z])


def affine(axes, origin=(0, 0, 0)):
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    matrix[:3, 3] = origin
    return matrix


def step(form):
    keys = set(form)
    if keys & {"from", "at", "to", "up"}:
        eye = np.asarray(form.get("from", [0, 0, 1]), float)
        at = np.asarray(form.get("at", form.get("to", [0, 0, 0])), float)
        return affine(frame(eye - at, form.get("up", [0, 1, 0])), eye)
    if "matrix" in keys:
        return np.asarray(form["matrix"], float).reshape(4, 4)
    if "translate" in keys:
        return affine(np.eye(3), form["translate"])
    if "scale" in keys:
        return affine(np.diag(np.broadcast_to(np.asarray(form["scale"], float), 3)))
    if keys == {"o", "x", "y", "z"}:
        return affine(np.column_stack([form["x"], form["y"], form["z"]]), form["o"])
    if "rotate" in keys:
        angle, axis = form["rotate"][0], form["rotate"][1:]
    elif keys == {"axis", "angle"}:
        angle, axis = form["angle"], form["axis"]
    else:
        raise Unconvertible(f"the transform {form!r}")
    x, y, z = unit(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(angle)
    return affine(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def transform(value):
    """The 4 × 4 matrix of a transform: steps in the order written, each multiplying on the left."""
    matrix = np.eye(4)
    for form in value if isinstance(value, list) else [value or {"translate": [0, 0, 0]}]:
        matrix = step(form) @ matrix
    return matrix


class Converter:
    """Converts one scene. `folder` takes the meshes, as PLY files that have to stay until the scene is loaded."""

    def __init__(self, mi, folder):
        self.mi = mi
        self.folder = folder
        self.smooth = False  # whether there is a surface that connections to the camera cannot see

    def to_world(self, matrix):
        return self.mi.ScalarTransform4f(matrix)

    def conductor(self, material, kind, two_sided):
        alpha = material.get("roughness", 0 if kind == "metal" else 0.1)
        rough = np.atleast_1d(alpha).max() >= 1e-4 if not isinstance(alpha, (dict, str)) else None
        if rough is None or not isinstance(alpha, (int, float)):
            raise Unconvertible("roughness that is not one number")
        if rough and material.get("masking", "height_correlated") != "separable":
            raise Unconvertible("height-correlated masking (Mitsuba's is separable)")
        self.smooth |= not rough
        bsdf = {"type": "roughconductor", "distribution": "ggx", "alpha": alpha} if rough else {"type": "conductor"}
        if "eta" in material:
            bsdf.update(eta=colour(material["eta"]), k=colour(material["k"]))
        elif kind == "metal" or material.get("fresnel", "schlick") == "none":
            bsdf.update(material="none", specular_reflectance=colour(material.get("albedo", 1)))
        else:
            raise Unconvertible("Schlick's approximation")
        return {"type": "twosided", "bsdf": bsdf} if two_sided else bsdf

    def material(self, material):
        """BSDF and emitter, either None where there is none."""
        kind = material["type"]
        emitter = None
        if "emit" in material:
            if material.get("emit_two_sided") or (kind == "diffuse light" and material.get("two_sided")):
                raise Unconvertible("surfaces that shine on both sides")
            emitter = {"type": "area", "radiance": colour(material["emit"])}
        shines = ("emit", "emit_two_sided")
        if kind == "diffuse light":
            only(material, kind, *shines, "two_sided")
            return {"type": "diffuse", "reflectance": colour(0)}, emitter
        if kind == "lambertian":
            only(material, kind, *shines, "albedo", "two_sided")
            bsdf = {"type": "diffuse", "reflectance": colour(material["albedo"])}
            return ({"type": "twosided", "bsdf": bsdf} if material.get("two_sided") else bsdf), emitter
        if kind in ("mirror", "metal"):
            only(material, kind, *shines, "albedo", *(["roughness"] if kind == "metal" else []))
            return self.conductor(material, "metal", True), emitter
        if kind == "conductor":
            only(material, kind, *shines, "albedo", "eta", "k", "fresnel", "roughness", "masking", "two_sided")
            return self.conductor(material, kind, material.get("two_sided", False)), emitter
        if kind in ("dielectric", "thin dielectric"):
            only(material, kind, *shines, "ior")
            self.smooth = True
            name = "dielectric" if kind == "dielectric" else "thindielectric"
            return {"type": name, "int_ior": float(material.get("ior", 1.5)), "ext_ior": 1.0}, emitter
        raise Unconvertible(f"the material type {kind}")

    def mesh(self, positions, indices, matrix, index, flip):
        positions = np.asarray(positions, float) @ matrix[:3, :3].T + matrix[:3, 3]
        triangles = []
        for face in indices:
            triangles += [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]
        # The winding tells the side, in Mitsuba as here; a mirroring transform does not turn it here.
        if flip != (np.linalg.det(matrix[:3, :3]) < 0):
            triangles = [(a, c, b) for a, b, c in triangles]
        path = self.folder / f"mesh{index}.ply"
        with open(path, "w") as out:
            out.write(f"ply\nformat ascii 1.0\nelement vertex {len(positions)}\n")
            out.write("property float x\nproperty float y\nproperty float z\n")
            out.write(f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
            out.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in positions)
            out.writelines("3 %d %d %d\n" % t for t in triangles)
        return {"type": "ply", "filename": str(path), "face_normals": True}

    def surface(self, surface, materials, index):
        kind = surface["type"]
        only(surface, f"surface {index}", "material", "transform", "flip_normals", "positions", "indices", "size", "radius")
        matrix = transform(surface.get("transform"))
        flip = surface.get("flip_normals", False)
        if kind in ("mesh", "triangle"):
            indices = surface["indices"] if kind == "mesh" else [[0, 1, 2]]
            if indices and not isinstance(indices[0], list):
                raise Unconvertible("meshes whose indices are not in lists of three or four")
            shape = self.mesh(surface["positions"], indices, matrix, index, flip)
        elif kind == "quad":
            x, y = np.broadcast_to(np.asarray(surface.get("size", 1), float), 2) / 2
            shape = self.mesh([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]], [[0, 1, 2, 3]], matrix, index, flip)
        elif kind == "sphere":
            axes = matrix[:3, :3]
            scale = np.cbrt(abs(np.linalg.det(axes)))
            if not np.allclose(axes.T @ axes, scale**2 * np.eye(3), rtol=1e-6, atol=1e-6 * scale**2):
                raise Unconvertible("ellipsoids")
            shape = {"type": "sphere", "radius": float(surface.get("radius", 1) * scale),
                     "center": [float(x) for x in matrix[:3, 3]], "flip_normals": flip}
        else:
            raise Unconvertible(f"the surface type {kind}")
        material = surface["material"]
        shape["bsdf"], emitter = self.material(material if isinstance(material, dict) else materials[material])
        if emitter:
            shape["emitter"] = emitter
        return shape

    def light(self, light):
        kind = light["type"]
        if kind == "point":
            only(light, kind, "position", "intensity")
            return {"type": "point", "position": light["position"], "intensity": colour(light["intensity"])}
        if kind == "spot":
            only(light, kind, "position", "at", "direction", "intensity", "inner_angle", "outer_angle", "profile", "falloff")
            inner, outer = float(light["inner_angle"]), float(light["outer_angle"])
            # Mitsuba's falls linearly with the angle. Over a hundredth of a degree nobody sees the difference.
            if light.get("profile", "cosine") != "angle" and outer - inner > 0.02:
                raise Unconvertible("spots that fall by the cosine between their angles (Mitsuba's: profile angle)")
            position = np.asarray(light["position"], float)
            toward = unit(light["direction"] if "direction" in light else np.asarray(light["at"], float) - position)
            up = np.eye(3)[np.argmin(np.abs(toward))]
            return {"type": "spot", "to_world": self.to_world(affine(frame(toward, up), position)),
                    "intensity": colour(light["intensity"]), "cutoff_angle": outer,
                    "beam_width": min(inner, outer - 1e-3)}
        if kind == "directional":
            only(light, kind, "direction", "irradiance")
            return {"type": "directional", "direction": light["direction"], "irradiance": colour(light["irradiance"])}
        if kind == "constant":
            only(light, kind, "radiance")
            return {"type": "constant", "radiance": colour(light["radiance"])}
        raise Unconvertible(f"the light type {kind}")

    def camera(self, camera):
        only(camera, "camera", "transform", "resolution", "vfov", "fdist", "aperture", "filter")
        if camera.get("type", "perspective") != "perspective" or camera.get("aperture", 0):
            raise Unconvertible("cameras other than pinholes")
        filter = camera.get("filter", {})
        if filter.get("type", "box") != "box" or filter.get("radius", 0.5) != 0.5:
            raise Unconvertible("filters other than the pixel itself")
        width, height = camera.get("resolution", [512, 512])
        # Theirs looks along +z with x to the left, ours along -z with x to the right.
        turned = transform(camera.get("transform")) @ np.diag([-1.0, 1.0, -1.0, 1.0])
        film = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                "component_format": "float32", "rfilter": {"type": "box"}}
        return {"type": "perspective", "fov_axis": "y", "fov": float(camera.get("vfov", 90)), "near_clip": 1e-3,
                "far_clip": 1e6, "to_world": self.to_world(turned), "film": film, "sampler": {"type": "independent"}}

    def scene(self, scene):
        """The dictionary of a parsed scene file."""
        only(scene, "scene", "camera", "integrator", "sampler", "image_samples", "background", "materials", "surfaces",
             "lights", "accelerator", "media")
        materials = {m["name"]: m for m in scene.get("materials", [])}
        out = {"type": "scene", "camera": self.camera(scene["camera"])}
        for index, surface in enumerate(scene.get("surfaces", [])):
            out[f"surface{index}"] = self.surface(surface, materials, index)
        for index, light in enumerate(scene.get("lights", [])):
            out[f"light{index}"] = self.light(light)
        background = scene.get("background", 0)
        if isinstance(background, dict):
            if background.get("type") != "constant":
                raise Unconvertible("environment images")
            background = background["color"]
        if np.any(background):
            out["background"] = {"type": "constant", "radiance": colour(background)}
        return out
