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

/// What can be had without swapping, within the limits of the process's control group and of those above it; `None` where the
/// system does not tell.
fn available() -> Option<u64> {
    let meminfo = fs::read_to_string("/proc/meminfo").ok()?;
    let free = meminfo.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    let free = free.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024;
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let read = |file: &str| fs::read_to_string(file).ok();
    Some(groups_of(&groups).iter().filter_map(|group| group.left(read)).fold(free, u64::min))
}

/// A control group's folder, and the files in it that tell of memory.
#[derive(Debug, PartialEq, Eq)]
struct Group {
    folder: String,
    /// Hard limit, and the one from which on the group is slowed down.
    limits: &'static [&'static str],
    /// What is taken of it.
    usage: &'static str,
    /// In `memory.stat`, the part of that which files' pages take that nobody used of late: it is given up for the asking.
    idle: &'static str,
}

impl Group {
    /// What its limits leave; `None` where there is none.
    fn left(&self, read: impl Fn(&str) -> Option<String>) -> Option<u64> {
        let number = |file: &str| read(&format!("{}/{file}", self.folder))?.trim().parse::<u64>().ok();
        // `max`, for none, is no number.
        let limit = self.limits.iter().filter_map(|file| number(file)).min()?;
        let stat = read(&format!("{}/memory.stat", self.folder)).unwrap_or_default();
        let idle = stat.lines().find_map(|line| line.strip_prefix(self.idle)?.trim().parse().ok()).unwrap_or(0);
        Some(limit.saturating_sub(number(self.usage).unwrap_or(0).saturating_sub(idle)))
    }
}

/// The groups that may hold a limit, given what `/proc/self/cgroup` says: the process's own and all above it, for both
/// versions of control groups.
fn groups_of(groups: &str) -> Vec<Group> {
    let mut all = Vec::new();
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        let (root, limits, usage, idle): (_, &[&str], _, _) = match controllers {
            "" => ("/sys/fs/cgroup", &["memory.max", "memory.high"], "memory.current", "inactive_file "),
            c if c.split(',').any(|c| c == "memory") => {
                ("/sys/fs/cgroup/memory", &["memory.limit_in_bytes"], "memory.usage_in_bytes", "total_inactive_file ")
            }
            _ => continue,
        };
        let mut path = path.trim_end_matches('/');
        loop {
            all.push(Group { folder: format!("{root}{path}"), limits, usage, idle });
            match path.rsplit_once('/') {
                Some((above, _)) => path = above,
                None => break,
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_group_and_above_count() {
        let folders = |text: &str| groups_of(text).into_iter().map(|g| g.folder).collect::<Vec<_>>();
        assert_eq!(
            folders("9:name=systemd:/\n4:cpu,memory:/a/b\n0::/user/x\n"),
            [
                "/sys/fs/cgroup/memory/a/b",
                "/sys/fs/cgroup/memory/a",
                "/sys/fs/cgroup/memory",
                "/sys/fs/cgroup/user/x",
                "/sys/fs/cgroup/user",
                "/sys/fs/cgroup",
            ]
        );
        assert_eq!(folders("0::/\n"), ["/sys/fs/cgroup"]);
        assert!(folders("nonsense").is_empty());
    }

    #[test]
    fn what_is_taken_is_not_left() {
        let [new] = &groups_of("0::/\n")[..] else { panic!("one group") };
        let [.., old] = &groups_of("4:memory:/\n")[..] else { panic!("a group") };
        let left = |group: &Group, files: &[(&str, &str)]| {
            group.left(|file| {
                let (_, name) = file.rsplit_once('/')?;
                files.iter().find(|(n, _)| *n == name).map(|(_, text)| (*text).to_owned())
            })
        };
        assert_eq!(left(new, &[]), None);
        assert_eq!(left(new, &[("memory.max", "max\n"), ("memory.high", "max\n"), ("memory.current", "7\n")]), None);
        assert_eq!(left(new, &[("memory.max", "1000\n"), ("memory.current", "700\n")]), Some(300));
        let files = [("memory.max", "1000\n"), ("memory.high", "900\n"), ("memory.current", "700\n")];
        assert_eq!(left(new, &files), Some(200));
        assert_eq!(left(new, &[&files[..], &[("memory.stat", "file 90\ninactive_file 50\n")]].concat()), Some(250));
        assert_eq!(left(new, &[("memory.max", "1000\n"), ("memory.current", "1700\n")]), Some(0));
        assert_eq!(left(old, &[("memory.limit_in_bytes", "10\n"), ("memory.usage_in_bytes", "4\n")]), Some(6));
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
