//! Finds Embree 4.3 or newer, generates the bindings from the headers that will be linked, compiles the shim, and
//! tells dependents how to link (`DEP_EMBREE4_*`):
//!
//! * `VERSION`: the headers' version, `4.3.3`;
//! * `INCLUDE`, `LIB`: the folders of `embree4/rtcore.h` and of the library;
//! * `LINK_ARGS`: arguments of the final link (run path, loader), separated by `;`, empty for a system library.
//!
//! Searched in this order: `EMBREE_DIR`; the system's folders; the private prefixes that `scripts/setup` makes, in
//! the clone and in the user's data folder.

use std::env;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const MIN_VERSION: (u32, u32) = (4, 3);
const MEND: &str = "What to do: run `scripts/setup` in the clone (no root needed), or set EMBREE_DIR to a folder \
                    with include/embree4/ and lib/";

/// Set in the child process that runs bindgen; see [`generate_bindings`].
const CHILD: &str = "EMBREE4_SYS_BINDGEN_CHILD";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            // `cargo::error` would be prettier, but is unknown to the oldest cargo this has to work with.
            eprintln!("\nerror: {message}\n");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let include = env::var_os("EMBREE4_SYS_INCLUDE");
    if env::var_os(CHILD).is_some() {
        return bindgen_here(&PathBuf::from(include.ok_or("the bindgen child was started without its folder")?));
    }
    for variable in ["EMBREE_DIR", "LIBCLANG_PATH", "XDG_DATA_HOME", "HOME"] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    for file in ["build.rs", "shim.c"] {
        println!("cargo::rerun-if-changed={file}");
    }
    let embree = Embree::find()?;
    println!("cargo::rerun-if-changed={}", embree.include.join("embree4").display());
    println!("cargo::rerun-if-changed={}", embree.lib.join(library_name()).display());

    generate_bindings(&embree.include)?;
    let bindings = out_dir()?.join("bindings.rs");
    let text = std::fs::read_to_string(&bindings).map_err(|e| format!("cannot read {}: {e}", bindings.display()))?;
    // Fields that exist only in some builds of Embree; the ABI tests cover them where they do. The layout assertions
    // that bindgen writes name each field with its struct.
    for (field, cfg) in [
        ("RTCHit::instPrimID", "inst_prim_id"),
        ("RTCRayQueryContext::instStackSize", "inst_stack_size"),
        ("RTCIntersectArguments::minWidthDistanceFactor", "min_width"),
    ] {
        if text.contains(&format!("field: {field}\"")) {
            println!("cargo::rustc-cfg=embree4=\"{cfg}\"");
        }
    }
    cc::Build::new()
        .file("shim.c")
        .include(&embree.include)
        .warnings(true)
        .extra_warnings(true)
        .compile("embree4_shim");

    println!("cargo::rustc-link-search=native={}", embree.lib.display());
    println!("cargo::rustc-link-lib=dylib=embree4");
    let args = embree.link_args();
    for arg in &args {
        println!("cargo::rustc-link-arg={arg}");
    }
    println!("cargo::metadata=VERSION={}", embree.version);
    println!("cargo::metadata=INCLUDE={}", embree.include.display());
    println!("cargo::metadata=LIB={}", embree.lib.display());
    println!("cargo::metadata=LINK_ARGS={}", args.join(";"));
    Ok(())
}

fn out_dir() -> Result<PathBuf, String> {
    env::var_os("OUT_DIR").map(PathBuf::from).ok_or_else(|| "OUT_DIR is not set: run this through cargo".to_owned())
}

fn target(what: &str) -> String {
    env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default()
}

/// The multiarch name of the target's library folder, as Debian and Ubuntu have it.
fn triple() -> String {
    format!("{}-linux-gnu", target("ARCH"))
}

fn library_name() -> &'static str {
    if target("OS") == "macos" { "libembree4.dylib" } else { "libembree4.so" }
}

/// An Embree that fits.
struct Embree {
    version: String,
    include: PathBuf,
    lib: PathBuf,
    /// Whether the system's loader finds the library without help.
    system: bool,
}

/// Where an Embree might be.
struct Place {
    include: Vec<PathBuf>,
    lib: Vec<PathBuf>,
    system: bool,
}

impl Place {
    /// A folder laid out as `make install` does, or as the distributions' packages do.
    fn plain(root: &Path) -> Self {
        let lib = root.join("lib");
        Self {
            include: vec![root.join("include")],
            lib: vec![lib.join(triple()), root.join("lib64"), lib],
            system: false,
        }
    }

    /// A folder of the user's choice: the above, or unpacked packages.
    fn chosen(root: &Path) -> Self {
        let (mut place, usr) = (Self::plain(root), Self::plain(&root.join("usr")));
        place.include.extend(usr.include);
        place.lib.extend(usr.lib);
        place
    }

    /// The Embree there, if it is one and new enough; what is wrong with it goes into `report`.
    fn look(&self, report: &mut String) -> Option<Embree> {
        for include in &self.include {
            let Some(version) = header_version(include, report) else { continue };
            if parse_version(&version).is_none_or(|v| v < MIN_VERSION) {
                let _ = writeln!(report, "  {}: Embree {version}, too old", include.display());
                continue;
            }
            if let Some(lib) = self.lib.iter().find(|l| l.join(library_name()).exists()) {
                // A place may be named by EMBREE_DIR and be the system's all the same.
                let real = lib.canonicalize().unwrap_or_else(|_| lib.clone());
                let system = self.system
                    || ["/usr/lib", "/lib"].iter().any(|s| [s.into(), Path::new(s).join(triple())].contains(&real));
                return Some(Embree { version, include: include.clone(), lib: lib.clone(), system });
            }
            let _ = writeln!(
                report,
                "  {}: headers of {version}, but no {} beside them",
                include.display(),
                library_name()
            );
        }
        None
    }
}

impl Embree {
    fn find() -> Result<Self, String> {
        let wanted = format!("Embree {}.{} or newer", MIN_VERSION.0, MIN_VERSION.1);
        let mut report = String::new();
        if let Some(dir) = env::var_os("EMBREE_DIR").filter(|d| !d.is_empty()) {
            // An explicit choice is not passed over in silence.
            let place = Place::chosen(Path::new(&dir));
            return place.look(&mut report).ok_or_else(|| {
                format!(
                    "EMBREE_DIR is `{}`, but {wanted} is not there.\n{report}What to do: correct it, or unset it to \
                     search the usual places",
                    Path::new(&dir).display()
                )
            });
        }
        let mut places =
            vec![Place { system: true, ..Place::plain(Path::new("/usr")) }, Place::plain(Path::new("/usr/local"))];
        if target("OS") == "macos" {
            places.push(Place::plain(Path::new("/opt/homebrew")));
        }
        places.extend(private_prefixes().iter().map(|p| Place::plain(&p.join("embree/usr"))));
        for place in &places {
            if let Some(found) = place.look(&mut report) {
                return Ok(found);
            }
        }
        let mut message = format!("{wanted} was not found. Searched for embree4/rtcore_config.h in:\n");
        for include in places.iter().flat_map(|p| &p.include) {
            let _ = writeln!(message, "  {}", include.display());
        }
        if !report.is_empty() {
            let _ = write!(message, "Found:\n{report}");
        }
        Err(message + MEND)
    }

    /// What the final link needs so that the program finds this library when it runs.
    fn link_args(&self) -> Vec<String> {
        if self.system {
            return Vec::new();
        }
        let mut args = vec![format!("-Wl,-rpath,{}", self.lib.display())];
        if target("OS") == "linux" {
            // RPATH, not RUNPATH: Embree's own search for TBB must see it too.
            args.insert(0, "-Wl,--disable-new-dtags".to_owned());
            let name = match target("ARCH").as_str() {
                "aarch64" => "ld-linux-aarch64.so.1",
                _ => "ld-linux-x86-64.so.2",
            };
            // A prefix with a C library of its own has its loader beside it: the system's may be too old for it.
            let loader = self.lib.join(name);
            if loader.exists() {
                args.push(format!("-Wl,--dynamic-linker={}", loader.display()));
                args.push("-Wl,--allow-shlib-undefined".to_owned());
            }
        }
        args
    }
}

/// The folders that `scripts/setup` fills: the clone's and the user's.
fn private_prefixes() -> Vec<PathBuf> {
    let mut prefixes = Vec::new();
    if let Some(workspace) = env::var_os("CARGO_MANIFEST_DIR").and_then(|d| Path::new(&d).parent().map(PathBuf::from)) {
        prefixes.push(workspace.join(".embree"));
    }
    let data = env::var_os("XDG_DATA_HOME")
        .filter(|d| !d.is_empty())
        .map(PathBuf::from)
        .or_else(|| env::var_os("HOME").map(|h| PathBuf::from(h).join(".local/share")));
    prefixes.extend(data.map(|d| d.join("twinlight/embree")));
    prefixes
}

/// The version in a header folder; an Embree 3 there is reported, so that the error can name it.
fn header_version(include: &Path, report: &mut String) -> Option<String> {
    let read = |name: &str| {
        let text = std::fs::read_to_string(include.join(name)).ok()?;
        let line = text.lines().find(|l| l.starts_with("#define RTC_VERSION_STRING"))?;
        line.split('"').nth(1).map(str::to_owned)
    };
    if let Some(old) = read("embree3/rtcore_config.h") {
        let _ = writeln!(report, "  {}: Embree {old}, too old", include.display());
    }
    read("embree4/rtcore_config.h")
}

fn parse_version(version: &str) -> Option<(u32, u32)> {
    let mut parts = version.split('.');
    Some((parts.next()?.parse().ok()?, parts.next()?.parse().ok()?))
}

/// Generates `$OUT_DIR/bindings.rs`.
///
/// A libclang from a private prefix needs its own LLVM, which the loader looks for only where it was told to when
/// the process started: this script then runs itself once more with the paths set, and bindgen works there.
fn generate_bindings(include: &Path) -> Result<(), String> {
    let private = private_prefixes().into_iter().find_map(|p| private_libclang(&p.join("libclang")));
    let (Some((clang, libraries)), None) = (private, env::var_os("LIBCLANG_PATH")) else {
        return bindgen_here(include);
    };
    let old = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    let path = env::join_paths(libraries.into_iter().chain(env::split_paths(&old)))
        .map_err(|e| format!("cannot put the folders of {} into LD_LIBRARY_PATH: {e}", clang.display()))?;
    let this = env::current_exe().map_err(|e| format!("cannot find this build script's own file: {e}"))?;
    let status = Command::new(this)
        .env(CHILD, "1")
        .env("EMBREE4_SYS_INCLUDE", include)
        .env("LIBCLANG_PATH", &clang)
        .env("LD_LIBRARY_PATH", path)
        .status()
        .map_err(|e| format!("cannot start bindgen's process: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("bindgen failed with the libclang in {}", clang.display())) }
}

/// The folder of libclang in a folder of unpacked packages, and those of the libraries it loads.
fn private_libclang(root: &Path) -> Option<(PathBuf, [PathBuf; 2])> {
    let llvm = std::fs::read_dir(root.join("usr/lib")).ok()?.filter_map(Result::ok).map(|e| e.path().join("lib"));
    let clang = llvm.filter(|p| has_libclang(p)).max()?;
    Some((clang, [root.join("usr/lib").join(triple()), root.join("lib").join(triple())]))
}

/// Whether bindgen finds a libclang in this folder. libclang-cpp is another library.
fn has_libclang(dir: &Path) -> bool {
    let files = std::fs::read_dir(dir).into_iter().flatten().filter_map(Result::ok);
    files.map(|f| f.file_name()).any(|name| {
        let name = name.to_string_lossy();
        let rest = name.strip_prefix("libclang").unwrap_or_default();
        rest.starts_with(".so") || rest.strip_prefix('-').is_some_and(|r| r.starts_with(|c: char| c.is_ascii_digit()))
    })
}

fn bindgen_here(include: &Path) -> Result<(), String> {
    let mut builder = bindgen::Builder::default()
        .header(include.join("embree4/rtcore.h").to_string_lossy())
        .clang_arg(format!("-I{}", include.display()))
        .allowlist_function("rtc.*")
        .allowlist_type("RTC.*")
        .allowlist_var("RTC_.*")
        // A C enum may hold a value that these headers do not know: plain integers, not Rust enums.
        .default_enum_style(bindgen::EnumVariation::Consts)
        .prepend_enum_name(false)
        .derive_default(true)
        .generate_comments(false)
        .layout_tests(true)
        .rust_target(bindgen::RustTarget::stable(85, 0).map_err(|e| e.to_string())?)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .use_core();
    // stddef.h and its like come with libclang's headers; where only the library is installed, the C compiler's do.
    if let Some(dir) = compiler_headers() {
        builder = builder.clang_arg(format!("-idirafter{}", dir.display()));
    }
    // bindgen panics when it cannot load libclang.
    let generated = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| builder.generate()));
    let bindings = match generated {
        Ok(Ok(bindings)) => bindings,
        Ok(Err(e)) => return Err(format!("no bindings to the headers in {}: {e}", include.display())),
        Err(_) => {
            return Err(
                "libclang, which bindgen reads the C headers with, cannot be loaded (see above). What to do: run \
                        `scripts/setup` in the clone, or set LIBCLANG_PATH to the folder of libclang.so"
                    .to_owned(),
            );
        }
    };
    let file = out_dir()?.join("bindings.rs");
    bindings.write_to_file(&file).map_err(|e| format!("cannot write {}: {e}", file.display()))
}

fn compiler_headers() -> Option<PathBuf> {
    let cc = env::var_os("CC").unwrap_or_else(|| "cc".into());
    let output = Command::new(cc).arg("-print-file-name=include").output().ok()?;
    let dir = PathBuf::from(String::from_utf8(output.stdout).ok()?.trim());
    dir.join("stddef.h").exists().then_some(dir)
}
