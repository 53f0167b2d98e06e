//! Files that appear whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::{OutputError, folder_of};

/// Writes a file through a temporary one in the same folder, which is flushed to the disk and then renamed: whatever
/// happens, the path holds either what it held before or all of `bytes`. Permissions of a file that was there are
/// kept, and a symbolic link stays one.
///
/// # Errors
/// When any step fails; the temporary file is removed, the old one untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let target = target(path);
    let error = |doing: &str, e: io::Error| {
        OutputError::new("write", path, format!("{doing} failed ({e}); check the folder's permissions and free space"))
    };
    let mut temporary = Temporary::create(&target).map_err(|e| error("creating a temporary file beside it", e))?;
    temporary.file.write_all(bytes).map_err(|e| error("writing the temporary file", e))?;
    if let Ok(old) = fs::metadata(&target) {
        temporary.file.set_permissions(old.permissions()).map_err(|e| error("taking over the permissions", e))?;
    }
    // Without this, a crash of the system after the rename could leave an empty file under the final name.
    temporary.file.sync_all().map_err(|e| error("flushing the temporary file to the disk", e))?;
    fs::rename(&temporary.path, &target).map_err(|e| error("renaming the temporary file", e))?;
    temporary.renamed = true;
    // Makes the rename itself durable where folders can be synchronised; elsewhere there is nothing to do.
    if let Ok(folder) = File::open(folder_of(&target)) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// The file a path stands for: where its link leads, if it is one.
pub(super) fn target(path: &Path) -> PathBuf {
    match fs::symlink_metadata(path) {
        Ok(there) if there.is_symlink() => fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        _ => path.to_owned(),
    }
}

/// A name beside `target` that no other process or call uses.
pub(super) fn temporary_name(target: &Path) -> PathBuf {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let mut name = OsString::from(".");
    name.push(target.file_name().unwrap_or_default());
    name.push(format!(".{}-{}.tmp", std::process::id(), CALLS.fetch_add(1, Ordering::Relaxed)));
    folder_of(target).join(name)
}

/// A temporary file that is removed when dropped before its renaming.
struct Temporary {
    file: File,
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    fn create(target: &Path) -> io::Result<Self> {
        let path = temporary_name(target);
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        Ok(Self { file, path, renamed: false })
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            let _ = fs::remove_file(&self.path);
        }
    }
}
