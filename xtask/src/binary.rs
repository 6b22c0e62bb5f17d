//! Reads programs and libraries of Windows (PE) and macOS (Mach-O): for which processor they are, what they need of the
//! system, and what they offer. So a build for another system is checked where it is made.

use anyhow::{Context, Result, bail, ensure};
use object::macho::Version;
use object::read::NameOrOrdinal;
use object::read::macho::{LoadCommandVariant, MachOFile64};
use object::{Architecture, BinaryFormat, Endianness, Object};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The libraries that every Windows 10 has. C++ and C runtimes that are installed separately are not among them.
const WINDOWS: [&str; 14] = [
    "advapi32.dll",
    "bcrypt.dll",
    "bcryptprimitives.dll",
    "crypt32.dll",
    "dbghelp.dll",
    "kernel32.dll",
    "msvcrt.dll",
    "ntdll.dll",
    "ole32.dll",
    "shell32.dll",
    "ucrtbase.dll",
    "user32.dll",
    "userenv.dll",
    "ws2_32.dll",
];

/// What a file needs and offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// The processor.
    pub architecture: Architecture,
    /// The functions that it needs, by library.
    pub imports: BTreeMap<String, BTreeSet<String>>,
    /// The functions that it offers.
    pub exports: BTreeSet<String>,
}

/// Reads a file of Windows, and fails where it needs more than x86-64 and what every Windows 10 has.
pub fn windows(path: &Path) -> Result<Report> {
    let data = read(path)?;
    let report = report(&data, BinaryFormat::Pe).with_context(|| format!("{path:?}"))?;
    ensure!(report.architecture == Architecture::X86_64, "{path:?}: found {:?}, expected x86-64", report.architecture);
    let system = |name: &str| WINDOWS.contains(&name) || name.starts_with("api-ms-win-");
    let foreign: Vec<_> = report.imports.keys().filter(|name| !system(name)).collect();
    ensure!(foreign.is_empty(), "{path:?} needs {foreign:?}, expected only what every Windows 10 has");
    Ok(report)
}

/// What a file of macOS says of itself beside its [`Report`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MacReport {
    /// What it needs and offers.
    pub report: Report,
    /// The oldest system that it runs on, such as "11.0".
    pub oldest: String,
    /// The libraries that it links.
    pub libraries: Vec<String>,
    /// Its own name; none for a program.
    pub install_name: Option<String>,
    /// Whether it has a signature, which Apple's processors ask for.
    pub signed: bool,
}

/// Reads a file of macOS, and fails where it needs more than Apple's processor and macOS 11.
pub fn macos(path: &Path) -> Result<MacReport> {
    let data = read(path)?;
    let found = mac_report(&data).with_context(|| format!("{path:?}"))?;
    ensure!(
        found.report.architecture == Architecture::Aarch64,
        "{path:?}: found {:?}, expected arm64",
        found.report.architecture
    );
    let foreign: Vec<_> = found.libraries.iter().filter(|name| !system_of_mac(name)).collect();
    ensure!(foreign.is_empty(), "{path:?} links {foreign:?}, expected only libraries of the system");
    let major = found.oldest.split('.').next().and_then(|text| text.parse::<u32>().ok());
    ensure!(major.is_some_and(|n| n <= 11), "{path:?} needs macOS {}, expected 11.0 at most", found.oldest);
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    if let Some(name) = &found.install_name {
        ensure!(*name == install_name(&file), "{path:?} calls itself {name:?}, expected {:?}", install_name(&file));
    }
    ensure!(found.signed, "{path:?} has no signature, expected an ad-hoc one: Apple's processors refuse it otherwise");
    Ok(found)
}

/// What a library of macOS calls itself: its file name, wherever it lies.
pub fn install_name(file: &str) -> String {
    format!("@rpath/{file}")
}

/// Fails where a file contains one of these paths of this machine.
pub fn assert_no_paths(path: &Path, paths: &[&Path]) -> Result<()> {
    let data = read(path)?;
    let text = String::from_utf8_lossy(&data);
    for foreign in paths {
        ensure!(!text.contains(&*foreign.to_string_lossy()), "{path:?} contains the path {foreign:?}");
    }
    Ok(())
}

fn system_of_mac(name: &str) -> bool {
    name.starts_with("/usr/lib/") || name.starts_with("/System/Library/Frameworks/")
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("cannot read {path:?}"))
}

fn report(data: &[u8], format: BinaryFormat) -> Result<Report> {
    let file = object::File::parse(data)?;
    ensure!(file.format() == format, "found a file of the format {:?}, expected {format:?}", file.format());
    let mut imports: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for import in file.imports()? {
        let import = import?;
        let library = String::from_utf8_lossy(import.library()).to_lowercase();
        imports.entry(library).or_default().insert(text(import.name()));
    }
    let exports = file.exports()?.map(|export| Ok(text(export?.name()))).collect::<Result<_>>()?;
    Ok(Report { architecture: file.architecture(), imports, exports })
}

fn mac_report(data: &[u8]) -> Result<MacReport> {
    let report = report(data, BinaryFormat::MachO)?;
    let file = MachOFile64::<Endianness>::parse(data)?;
    let endian = file.endian();
    let (mut oldest, mut libraries, mut install_name, mut signed) = (String::new(), Vec::new(), None, false);
    let mut commands = file.macho_load_commands()?;
    while let Some(command) = commands.next()? {
        let name = |dylib: &object::macho::DylibCommand<Endianness>| -> Result<String> {
            Ok(String::from_utf8_lossy(command.string(endian, dylib.dylib.name)?).into_owned())
        };
        match command.variant()? {
            LoadCommandVariant::BuildVersion(version, _) => oldest = shown(version.minos.get(endian)),
            LoadCommandVariant::VersionMin(version) => oldest = shown(version.version.get(endian)),
            LoadCommandVariant::IdDylib(dylib) => install_name = Some(name(dylib)?),
            LoadCommandVariant::Dylib(dylib) => libraries.push(name(dylib)?),
            LoadCommandVariant::LinkeditData(data) => {
                signed |= data.cmd.get(endian) == object::macho::LC_CODE_SIGNATURE && data.datasize.get(endian) > 0;
            }
            _ => {}
        }
    }
    if oldest.is_empty() {
        bail!("found no oldest version of the system");
    }
    Ok(MacReport { report, oldest, libraries, install_name, signed })
}

/// A name; a function of Windows may have only a number.
fn text(name: NameOrOrdinal<&[u8]>) -> String {
    match name {
        NameOrOrdinal::Name(name) => String::from_utf8_lossy(name).into_owned(),
        NameOrOrdinal::Ordinal(number) => format!("#{number}"),
    }
}

/// The first two numbers of a version.
fn shown(version: Version) -> String {
    format!("{}.{}", version.major(), version.minor())
}

/// Fails unless exactly the functions of a list that begin with `prefix` are offered.
pub fn assert_exports(path: &Path, report: &Report, prefix: &str, expected: &BTreeSet<String>) -> Result<()> {
    let found: BTreeSet<String> = report.exports.iter().filter(|name| name.starts_with(prefix)).cloned().collect();
    let missing: Vec<_> = expected.difference(&found).collect();
    let more: Vec<_> = found.difference(expected).collect();
    ensure!(missing.is_empty() && more.is_empty(), "{path:?} offers {more:?} beside, and lacks {missing:?}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_refused() {
        assert!(report(b"MZ", BinaryFormat::Pe).is_err());
        assert!(mac_report(b"text").is_err());
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        if cfg!(target_os = "linux") {
            assert!(report(&own, BinaryFormat::Pe).is_err() && mac_report(&own).is_err());
        }
    }

    #[test]
    fn paths_of_the_machine_are_found() {
        let own = std::env::current_exe().unwrap();
        let error =
            assert_no_paths(&own, &[Path::new("/no/such/path-of-a-machine"), Path::new(env!("CARGO_MANIFEST_DIR"))]);
        // The test names both, so its own program contains the first one at least.
        assert!(error.unwrap_err().to_string().contains("contains the path"));
        let text = xtask_shell::shell::root().join("LICENSE");
        assert_no_paths(&text, &[Path::new("/no/such/path-of-a-machine")]).unwrap();
    }

    #[test]
    fn versions_of_macos_are_shown() {
        assert_eq!(shown(Version::new(11, 0, 0)), "11.0");
        assert_eq!(shown(Version::new(10, 15, 7)), "10.15");
    }

    #[test]
    fn missing_functions_are_named() {
        let report = Report {
            architecture: Architecture::X86_64,
            imports: BTreeMap::new(),
            exports: ["a_one", "b"].map(String::from).into(),
        };
        let path = Path::new("x.dll");
        assert!(assert_exports(path, &report, "a_", &["a_one".to_owned()].into()).is_ok());
        let error = assert_exports(path, &report, "a_", &["a_two".to_owned()].into()).unwrap_err().to_string();
        assert!(error.contains("a_one") && error.contains("lacks [\"a_two\"]"), "{error}");
    }
}
