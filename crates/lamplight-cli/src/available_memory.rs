//! The memory that this process can still get: the least of what the machine, the container and the
//! limit on the address space leave.

use std::fs;
use std::sync::OnceLock;

/// Address space that each thread reserves and hardly uses: its stack, and the allocator's arena, 64 MB
/// with glibc.
const THREAD: u64 = 66 << 20;

/// The number of bytes that this process can still allocate, if the system reports it.
pub fn available() -> Option<u64> {
    [address_space(), physical(), container()].into_iter().flatten().min()
}

/// The address space taken before any thread was started.
static BEFORE_THREADS: OnceLock<u64> = OnceLock::new();

/// Records the address space that is taken before threads are started.
pub fn threads_are_about_to_start() {
    BEFORE_THREADS.get_or_init(taken_address_space);
}

/// Returns the address space that this process takes (Linux; 0 elsewhere).
fn taken_address_space() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    kilobytes(&status, "VmSize:").unwrap_or(0)
}

/// Returns the bytes that remain under the limit on the address space (`ulimit -v`), if there is one.
fn address_space() -> Option<u64> {
    #[cfg(unix)]
    {
        let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
        // Some threads may have reserved their part already.
        let threads = THREAD * rayon::current_num_threads() as u64;
        let at_least = BEFORE_THREADS.get().copied().unwrap_or(0) + threads;
        Some(limit.saturating_sub(taken_address_space().max(at_least)))
    }
    #[cfg(not(unix))]
    None
}

/// Free memory of the machine (Linux).
fn physical() -> Option<u64> {
    let info = fs::read_to_string("/proc/meminfo").ok()?;
    Some(kilobytes(&info, "MemAvailable:")? + kilobytes(&info, "SwapFree:").unwrap_or(0))
}

/// The limit of the container (Linux, cgroup 2).
fn container() -> Option<u64> {
    fs::read_to_string("/sys/fs/cgroup/memory.max").ok()?.trim().parse().ok()
}

/// The bytes of a line such as `VmSize:  1234 kB`.
fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(number * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_proc_are_read() {
        let text = "VmPeak:\t    10 kB\nVmSize:\t  2048 kB\nHugePages_Free: 3\n";
        assert_eq!(kilobytes(text, "VmSize:"), Some(2048 * 1024));
        assert_eq!(kilobytes(text, "VmSwap:"), None);
        assert_eq!(kilobytes(text, "HugePages_Free:"), None, "it is no size");
    }
}
