//! The memory that this process can still get: the least of what the machine, the container and the
//! limit on the address space leave.

use std::fs;
use std::path::Path;
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

/// The bytes that the limits of the container leave (Linux, cgroup 2).
fn container() -> Option<u64> {
    let own = fs::read_to_string("/proc/self/cgroup").ok()?;
    left_in_groups(Path::new("/sys/fs/cgroup"), &own)
}

/// Returns the least that the group of a process and those around it leave, of the groups below `root`. `own` is the text of
/// `/proc/self/cgroup`.
fn left_in_groups(root: &Path, own: &str) -> Option<u64> {
    let group = own.lines().find_map(|line| line.strip_prefix("0::/"))?;
    let read = |group: &Path, file: &str| fs::read_to_string(root.join(group).join(file)).ok();
    let bytes = |group: &Path, file: &str| read(group, file)?.trim().parse::<u64>().ok();
    let left = |group: &Path| {
        // The text is `max` where there is no limit.
        let most = bytes(group, "memory.max")?;
        // Cached files give way.
        let stat = read(group, "memory.stat").unwrap_or_default();
        let cached = ["active_file", "inactive_file"].map(|key| count(&stat, key).unwrap_or(0));
        let taken = bytes(group, "memory.current").unwrap_or(0);
        Some(most.saturating_sub(taken.saturating_sub(cached.iter().sum())))
    };
    Path::new(group).ancestors().filter_map(left).min()
}

/// The number of a line such as `inactive_file 1234`.
fn count(text: &str, key: &str) -> Option<u64> {
    let mut lines = text.lines().filter_map(|line| line.split_once(' '));
    lines.find(|(found, _)| *found == key)?.1.parse().ok()
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
    fn the_tightest_group_counts_with_what_it_has_taken() {
        let root = tempfile::tempdir().unwrap();
        let own = "1:cpu:/other\n0::/a.slice/b.scope\n";
        assert_eq!(left_in_groups(root.path(), own), None);
        let group = |path: &str, most: &str, taken: &str| {
            let folder = root.path().join(path);
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("memory.max"), format!("{most}\n")).unwrap();
            fs::write(folder.join("memory.current"), format!("{taken}\n")).unwrap();
        };
        group("a.slice/b.scope", "max", "70");
        assert_eq!(left_in_groups(root.path(), own), None);
        group("a.slice", "1000", "400");
        assert_eq!(left_in_groups(root.path(), own), Some(600));
        group("a.slice/b.scope", "500", "70");
        assert_eq!(left_in_groups(root.path(), own), Some(430));
        let stat = "anon 10\ninactive_file 15\nactive_file 5\n";
        fs::write(root.path().join("a.slice/b.scope/memory.stat"), stat).unwrap();
        assert_eq!(left_in_groups(root.path(), own), Some(450));
        // A container sees its own group as the root.
        group("", "200", "300");
        assert_eq!(left_in_groups(root.path(), own), Some(0));
        assert_eq!(left_in_groups(root.path(), "0::/\n"), Some(0));
        assert_eq!(left_in_groups(root.path(), "4:memory:/a.slice\n"), None, "it is of cgroup 1");
    }

    #[test]
    fn lines_of_proc_are_read() {
        let text = "VmPeak:\t    10 kB\nVmSize:\t  2048 kB\nHugePages_Free: 3\n";
        assert_eq!(kilobytes(text, "VmSize:"), Some(2048 * 1024));
        assert_eq!(kilobytes(text, "VmSwap:"), None);
        assert_eq!(kilobytes(text, "HugePages_Free:"), None, "it is no size");
    }
}
