//! `aureole-hostile PROGRAM FOLDER`: damages copies of the files in a folder, one at a time, and has the program render them.
//!
//! Scenes and meshes are rendered themselves, other files through a small scene that asks for them. What counts as a
//! fault: a crash or a panic, an end with an unexpected code, more than 5 s, more than 1 GiB, a message that does not
//! name the file. Faulty files are kept.

#![expect(clippy::print_stdout, reason = "a program that reports to people")]

use std::error::Error;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use aureole_hostile::corrupt::Corruptor;
use clap::Parser;

/// Damages copies of the files in a folder, and has a program render them.
#[derive(Debug, Parser)]
struct Args {
    /// The program `aureole`
    program: PathBuf,
    /// Good files
    folder: PathBuf,
    /// Damaged copies in all
    #[arg(long, default_value_t = 5000)]
    count: u64,
    /// Another seed does other damage
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Files beyond this many bytes are left out
    #[arg(long, default_value_t = 4 << 20)]
    largest: u64,
    /// Where faulty files are kept
    #[arg(long, default_value = "faults")]
    keep: PathBuf,
}

const PATIENCE: Duration = Duration::from_secs(5);
const MEMORY: u64 = 1 << 30;
/// The scene that asks for a file that is none itself.
const WRAPPER: &str = "asks-for-it";
/// Done; wrong scene or asset; a limit was met.
const EXPECTED: [Option<i32>; 3] = [Some(0), Some(3), Some(5)];

/// How a run went.
struct Outcome {
    code: Option<i32>,
    seconds: f64,
    peak_memory: u64,
    stderr: String,
    timed_out: bool,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let args = Args::parse();
    let program = args.program.canonicalize()?;
    let root = args.folder.canonicalize()?;
    let mut files = Vec::new();
    collect(&root, &root, args.largest, &mut files)?;
    files.sort();
    if files.is_empty() {
        return Err("no files of a known kind in the folder".into());
    }
    let (mut faults, mut codes, mut slowest, mut largest) = (0, [0u64; 3], 0.0f64, 0);
    for i in 0..args.count {
        let relative = &files[(i % files.len() as u64) as usize];
        let damaged = Corruptor::new(args.seed ^ i << 20 ^ i).corrupt(&fs::read(root.join(relative))?);
        let stage = tempfile::tempdir()?;
        let place = mirror(&root, relative, stage.path())?;
        fs::write(&place, &damaged.bytes)?;
        let scene = scene_for(&place, stage.path())?;
        let outcome = run(&program, &scene, stage.path())?;
        slowest = slowest.max(outcome.seconds);
        largest = largest.max(outcome.peak_memory);
        if let Some(kind) = EXPECTED.iter().position(|code| *code == outcome.code) {
            codes[kind] += 1;
        }
        if let Some(fault) = fault(&outcome, &place) {
            faults += 1;
            println!("{fault}: {} ({}, copy {i})", relative.display(), damaged.what);
            fs::create_dir_all(&args.keep)?;
            let name = place.file_name().unwrap_or(OsStr::new("file")).to_string_lossy();
            fs::write(args.keep.join(format!("{i}-{name}")), &damaged.bytes)?;
            fs::write(args.keep.join(format!("{i}-{name}.txt")), &outcome.stderr)?;
        }
    }
    println!(
        "{} damaged copies of {} files: {} rendered, {} refused, {} beyond limits, {faults} faults; \
         at most {slowest:.2} s and {} MiB",
        args.count,
        files.len(),
        codes[0],
        codes[1],
        codes[2],
        largest >> 20,
    );
    Ok(if faults == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The kinds of files that something reads.
fn is_known(path: &Path) -> bool {
    const KNOWN: [&str; 19] = [
        "pbrt",
        "xml",
        "ply",
        "obj",
        "mtl",
        "serialized",
        "vol",
        "exr",
        "png",
        "jpg",
        "jpeg",
        "hdr",
        "pfm",
        "ppm",
        "bmp",
        "tga",
        "tif",
        "tiff",
        "gz",
    ];
    suffix(path).is_some_and(|suffix| KNOWN.contains(&suffix))
}

fn suffix(path: &Path) -> Option<&str> {
    path.extension().and_then(OsStr::to_str)
}

/// All known files below a folder, by their paths from the root.
fn collect(root: &Path, folder: &Path, largest: u64, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let (path, meta) = (entry.path(), entry.metadata()?);
        if meta.is_dir() {
            collect(root, &path, largest, files)?;
        } else if is_known(&path) && (1..=largest).contains(&meta.len()) {
            files.push(path.strip_prefix(root)?.to_owned());
        }
    }
    Ok(())
}

/// Makes a folder look like `root`, but with a place of its own for one file, which is given back.
fn mirror(root: &Path, relative: &Path, stage: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let (mut from, mut to) = (root.to_owned(), stage.to_owned());
    for part in relative.iter() {
        fs::create_dir_all(&to)?;
        for entry in fs::read_dir(&from)? {
            let entry = entry?;
            if entry.file_name() != part {
                symlink(entry.path(), to.join(entry.file_name()))?;
            }
        }
        (from, to) = (from.join(part), to.join(part));
    }
    Ok(to)
}

/// The scene to render: the file itself, or a scene that asks for it.
fn scene_for(file: &Path, stage: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let name = format!("<string name=\"filename\" value=\"{}\"/>", file.display());
    let shape = match suffix(file) {
        Some("pbrt" | "xml" | "ply" | "obj" | "gz") => return Ok(file.to_owned()),
        Some("mtl") => {
            let text = format!("mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", file.display());
            let object = stage.join(WRAPPER).with_extension("obj");
            fs::write(&object, text)?;
            return Ok(object);
        }
        Some("serialized") => format!("<shape type=\"serialized\">{name}</shape>"),
        Some("vol") => format!("<shape type=\"sdfgrid\">{name}</shape>"),
        Some("exr" | "hdr") => format!("<emitter type=\"envmap\">{name}</emitter>"),
        _ => format!(
            "<shape type=\"rectangle\"><bsdf type=\"diffuse\">\
             <texture type=\"bitmap\" name=\"reflectance\">{name}</texture></bsdf></shape>"
        ),
    };
    let scene = stage.join(WRAPPER).with_extension("xml");
    fs::write(&scene, format!("<scene version=\"3.0.0\">{shape}<emitter type=\"constant\"/></scene>"))?;
    Ok(scene)
}

/// Renders one sample for each of a few pixels.
fn run(program: &Path, scene: &Path, stage: &Path) -> Result<Outcome, Box<dyn Error>> {
    let errors = stage.join("stderr.txt");
    let start = Instant::now();
    let mut child = Command::new(program)
        .args(["render", "--resolution", "8x8", "--spp", "1", "--threads", "1", "-o"])
        .arg(stage.join("image.pfm"))
        .arg(scene)
        .current_dir(stage)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(fs::File::create(&errors)?)
        .spawn()?;
    let (mut peak, mut timed_out) = (0, false);
    let status = loop {
        peak = peak.max(peak_memory(&child).unwrap_or(0));
        if let Some(status) = child.try_wait()? {
            break status;
        }
        // Twice the patience: enough to see the memory of what hangs.
        if start.elapsed() > 2 * PATIENCE {
            timed_out = true;
            child.kill()?;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let stderr = String::from_utf8_lossy(&fs::read(&errors)?).into_owned();
    Ok(Outcome {
        code: status.code(),
        seconds: start.elapsed().as_secs_f64(),
        peak_memory: peak,
        stderr,
        timed_out,
    })
}

/// The most memory that a process has had so far, where the system tells.
fn peak_memory(child: &Child) -> Option<u64> {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kibibytes| kibibytes << 10)
}

/// What is wrong with a run.
fn fault(outcome: &Outcome, damaged: &Path) -> Option<String> {
    if outcome.timed_out || outcome.seconds > PATIENCE.as_secs_f64() {
        return Some(format!("{:.1} s", outcome.seconds));
    }
    if outcome.stderr.contains("panicked at") {
        return Some("panic".to_owned());
    }
    if !EXPECTED.contains(&outcome.code) {
        return Some(format!("ended with {:?}", outcome.code));
    }
    if outcome.peak_memory > MEMORY {
        return Some(format!("{} MiB", outcome.peak_memory >> 20));
    }
    // The place may be in another file, which uses what this one gives; but not in the scene that only asks for it.
    let name = damaged.file_name().unwrap_or(OsStr::new("")).to_string_lossy();
    let elsewhere = outcome.stderr.contains("─[") && !outcome.stderr.contains(WRAPPER);
    let has_place = outcome.code == Some(0) || elsewhere || outcome.stderr.contains(&*name);
    (!has_place).then(|| "a message without a place".to_owned())
}
