//! How much memory a render may take: what the command line allows, or most of what the machine has left.

use std::fs;

use super::args::RenderArgs;

/// Where the system tells nothing.
const USUAL: u64 = 16 << 30;

/// The share of what is available that is taken without being asked for.
const SHARE: f64 = 0.8;

/// The memory that may be taken.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    pub bytes: u64,
    /// Whether the command line names it.
    given: bool,
}

impl Limit {
    /// What `--max-memory` says, or what is sensible here.
    pub fn of(args: &RenderArgs) -> Self {
        args.max_memory.map_or_else(Self::sensible, |size| Self { bytes: size.0, given: true })
    }

    /// What is sensible here.
    pub fn sensible() -> Self {
        let bytes = available().map_or(USUAL, |bytes| (bytes as f64 * SHARE) as u64);
        Self { bytes, given: false }
    }

    /// Why it is this, after "more than".
    pub fn words(&self) -> String {
        let bytes = size(self.bytes);
        if self.given {
            format!("the {bytes} of --max-memory")
        } else {
            format!("the {bytes} that are left to take here")
        }
    }
}

/// A size in words.
pub fn size(bytes: u64) -> String {
    let mib = bytes as f64 / f64::from(1 << 20);
    if mib < 1000.0 { format!("{mib:.1} MiB") } else { format!("{:.1} GiB", mib / 1024.0) }
}

/// What can be had without swapping, within the limits of the process's control group; `None` where the system does not
/// tell.
fn available() -> Option<u64> {
    let meminfo = fs::read_to_string("/proc/meminfo").ok()?;
    let free = meminfo.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let free = free.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024;
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let limits = limit_files(&groups).into_iter().filter_map(|file| fs::read_to_string(file).ok());
    // `max`, for none, is no number.
    Some(limits.filter_map(|text| text.trim().parse().ok()).fold(free, u64::min))
}

/// The files that may hold a limit, given what `/proc/self/cgroup` says: those of the group and of all above it, for both
/// versions of control groups.
fn limit_files(groups: &str) -> Vec<String> {
    let mut files = Vec::new();
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (root, file) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            c if c.split(',').any(|c| c == "memory") => ("/sys/fs/cgroup/memory", "memory.limit_in_bytes"),
            _ => continue,
        };
        let mut path = path.trim_end_matches('/');
        loop {
            files.push(format!("{root}{path}/{file}"));
            match path.rsplit_once('/') {
                Some((above, _)) => path = above,
                None => break,
            }
        }
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_group_and_above_count() {
        let files = limit_files("9:name=systemd:/\n4:cpu,memory:/a/b\n0::/user/x\n");
        assert_eq!(
            files,
            [
                "/sys/fs/cgroup/memory/a/b/memory.limit_in_bytes",
                "/sys/fs/cgroup/memory/a/memory.limit_in_bytes",
                "/sys/fs/cgroup/memory/memory.limit_in_bytes",
                "/sys/fs/cgroup/user/x/memory.max",
                "/sys/fs/cgroup/user/memory.max",
                "/sys/fs/cgroup/memory.max",
            ]
        );
        assert_eq!(limit_files("0::/\n"), ["/sys/fs/cgroup/memory.max"]);
        assert!(limit_files("nonsense").is_empty());
    }

    #[test]
    fn sizes_in_words() {
        for (bytes, words) in [(0, "0.0 MiB"), (5 << 20, "5.0 MiB"), (3 << 29, "1.5 GiB"), (16 << 30, "16.0 GiB")] {
            assert_eq!(size(bytes), words);
        }
        let limit = Limit::sensible();
        assert!(limit.bytes > 1 << 20 && limit.words().contains("left to take here"), "{limit:?}");
    }
}
