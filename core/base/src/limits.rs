//! The memory that the machine has free, and the least limit of the containers around this process.
//!
//! A container (Docker, Kubernetes, a systemd slice, a job of a farm's engine) ends what grows beyond its limit, though the
//! machine has memory left. On Linux limits are in control groups. `/proc/self/cgroup` names the group of the process, and a
//! group's limit holds for all groups below it. So every group on the way up to the root is read: `memory.max` in version 2,
//! `memory.limit_in_bytes` in version 1. Inside a container the way may begin at the container itself, or lead through groups
//! that cannot be seen; what cannot be read limits nothing.
//!
//! Limit: what other processes of the container hold is not subtracted from its limit.

use std::fs;
use std::path::Path;

/// Where the groups are mounted: in version 2 alone, or beside version 1.
const GROUPS: [&str; 2] = ["sys/fs/cgroup", "sys/fs/cgroup/unified"];
/// Where version 1 mounts its groups for memory.
const MEMORY_GROUPS: [&str; 1] = ["sys/fs/cgroup/memory"];

/// Bytes that this process may take now; `None` where the system does not say it.
pub fn free() -> Option<u64> {
    least(Path::new("/"))
}

/// The least of the machine's free memory and all limits, by the files below `root`.
fn least(root: &Path) -> Option<u64> {
    let text = |path: &str| fs::read_to_string(root.join(path)).ok();
    let machine = text("proc/meminfo").and_then(|text| available(&text));
    let groups = text("proc/self/cgroup").unwrap_or_default();
    machine.into_iter().chain(groups.lines().flat_map(|line| limits(root, line))).min()
}

/// The limits of a group and of all above it, by a line of `/proc/self/cgroup`: number, controllers and path. Version 2 has no
/// controllers in it.
fn limits(root: &Path, line: &str) -> Vec<u64> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { return Vec::new() };
    let (mounts, file) = match controllers {
        "" => (&GROUPS[..], "memory.max"),
        _ if controllers.split(',').any(|name| name == "memory") => (&MEMORY_GROUPS[..], "memory.limit_in_bytes"),
        _ => return Vec::new(),
    };
    // "max" is no number, and the largest number of version 1 is more than any machine has.
    let limit = |mount: &str, group: &Path| {
        fs::read_to_string(root.join(mount).join(group).join(file)).ok()?.trim().parse::<u64>().ok()
    };
    let groups = || Path::new(path.trim_start_matches('/')).ancestors();
    mounts.iter().flat_map(|mount| groups().filter_map(move |group| limit(mount, group))).collect()
}

/// The free memory by the text of `/proc/meminfo`.
fn available(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least limit of a machine with these files.
    fn of(files: &[(&str, &str)]) -> Option<u64> {
        let root = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        least(root.path())
    }

    const MACHINE: (&str, &str) = ("proc/meminfo", "MemTotal: 9 kB\nMemAvailable:    1000 kB\n");

    #[test]
    fn free_memory_is_read() {
        assert_eq!(of(&[MACHINE]), Some(1_024_000));
        assert_eq!(of(&[("proc/meminfo", "MemTotal: 9 kB\n")]), None);
    }

    #[test]
    fn the_least_limit_on_the_way_up_holds() {
        let own = ("proc/self/cgroup", "0::/farm.slice/job\n");
        let job = |text| ("sys/fs/cgroup/farm.slice/job/memory.max", text);
        let slice = ("sys/fs/cgroup/farm.slice/memory.max", "500000\n");
        assert_eq!(of(&[MACHINE, own, job("700000\n"), slice]), Some(500_000));
        assert_eq!(of(&[MACHINE, own, job("300000\n"), slice]), Some(300_000));
        assert_eq!(of(&[MACHINE, own, job("max\n")]), Some(1_024_000));
        assert_eq!(of(&[own, job("300000\n")]), Some(300_000), "without the machine's");
        // In a container the root is the container.
        let inside = [MACHINE, ("proc/self/cgroup", "0::/\n"), ("sys/fs/cgroup/memory.max", "200000\n")];
        assert_eq!(of(&inside), Some(200_000));
    }

    #[test]
    fn groups_of_version_1_are_read() {
        let own = ("proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/docker/a:b\n3:cpu:/x\n0::/\n");
        let none = ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
        let group = ("sys/fs/cgroup/memory/docker/a:b/memory.limit_in_bytes", "400000\n");
        assert_eq!(of(&[MACHINE, own, none, group]), Some(400_000));
        assert_eq!(of(&[MACHINE, own, none]), Some(1_024_000));
        // The container does not see its own path.
        let inside = ("sys/fs/cgroup/memory/memory.limit_in_bytes", "300000\n");
        assert_eq!(of(&[MACHINE, own, inside]), Some(300_000));
    }
}
