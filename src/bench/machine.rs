//! What the system tells of the process and of the machine. Each answer is `None` where it tells nothing.

use std::fs;

/// Seconds of processor time that this process has used, those of all its threads, ended ones too. Resolved to the
/// nanosecond by the clock, and by Linux to what its scheduler accounts, well below a millisecond.
pub fn cpu_seconds() -> Option<f64> {
    #[cfg(unix)]
    {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64)
    }
    #[cfg(not(unix))]
    {
        None
    }
}

/// Largest resident memory of this process in bytes, since its start or the last [`reset_peak_memory`].
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// Lets [`peak_memory`] count anew from what is resident now; false where that cannot be done.
pub fn reset_peak_memory() -> bool {
    // proc(5), /proc/pid/clear_refs: 5 resets the peak (Linux 4.0 or newer).
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// The machine that a benchmark ran on.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The processor's name.
    pub cpu: Option<String>,
    /// Hardware threads that this process may use.
    pub processors: usize,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// This one.
    pub fn this() -> Self {
        let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = info.lines().find_map(|l| l.strip_prefix("model name")?.split_once(':'));
        Self {
            cpu: name.map(|(_, name)| name.trim().to_owned()),
            processors: std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Work takes time, and finer than the ticks of /proc; threads that have ended count.
    #[cfg(unix)]
    #[test]
    fn processor_time_is_fine_and_of_all_threads() {
        let work = || (0..200_000_u64).fold(1_u64, |x, i| std::hint::black_box(x.wrapping_mul(31).wrapping_add(i)));
        let start = cpu_seconds().expect("unix");
        std::hint::black_box(work());
        let one = cpu_seconds().expect("unix") - start;
        assert!(one > 0.0 && one < 60.0, "{one}");
        let start = cpu_seconds().expect("unix");
        std::thread::spawn(move || (0..200).map(|_| work()).fold(0, u64::wrapping_add)).join().expect("no panic");
        let many = cpu_seconds().expect("unix") - start;
        // 40 million steps, each of them some cycles.
        assert!(many > 5e-3, "{many}");
        // A difference that ticks of 1/100 s could not have.
        let ticks = 100.0 * one;
        assert!((ticks - ticks.round()).abs() > 1e-9, "{one}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_peak_is_of_what_came_after_its_reset() {
        let big = vec![1_u8; 64 << 20];
        let with = peak_memory().expect("linux");
        assert!(with > 64 << 20 && big.iter().map(|x| u64::from(*x)).sum::<u64>() == 64 << 20);
        drop(big);
        // Containers may forbid it.
        if reset_peak_memory() {
            assert!(peak_memory().expect("linux") < with);
        }
    }
}
