//! The command line.

use std::ops::Range;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use aureole::image::{Format, ToneCurve};
use clap::builder::PossibleValuesParser;
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};

use crate::command::bench::BenchArgs;

/// Renders scenes by following light.
///
/// Reads pbrt-v4 and Mitsuba 3 scenes, and PLY and OBJ meshes; writes EXR, PNG, JPEG, HDR, PFM and PPM.
#[derive(Debug, Parser)]
#[command(name = "aureole", version, propagate_version = true, max_term_width = 110)]
#[command(after_help = "Exit codes: 0 done, 1 a comparison failed, 2 wrong usage, 3 wrong scene or asset, \
    4 cannot write, 5 a limit was met, 130 and 143 interrupted after writing what there was.")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a scene to an image
    Render(RenderArgs),
    /// Show what a scene consists of, and what of it is not understood
    Info(InfoArgs),
    /// List the elements that scenes are made of, with their parameters
    List(ListArgs),
    /// Put together what was rendered in parts (`render --shard`)
    Merge(MergeArgs),
    /// Measure how far an image is from a reference
    Diff(DiffArgs),
    /// List, show or render the scenes that come with the program
    Gallery(GalleryArgs),
    /// Measure how fast rays are
    Bench(BenchArgs),
}

impl Command {
    /// Whether messages are for programs.
    pub(crate) fn json(&self) -> bool {
        match self {
            Self::Render(args) => args.json,
            Self::Info(args) => args.json,
            Self::List(args) => args.json,
            Self::Merge(args) => args.json,
            Self::Diff(args) => args.json,
            Self::Gallery(args) => args.json,
            Self::Bench(_) => false,
        }
    }

    /// How loud to be.
    pub(crate) fn loudness(&self) -> Loudness {
        match self {
            Self::Render(args) => args.loudness,
            Self::Info(args) => args.loudness,
            Self::Gallery(args) => args.loudness,
            Self::List(_) | Self::Merge(_) | Self::Diff(_) | Self::Bench(_) => Loudness::default(),
        }
    }
}

/// The scene and what is changed about it.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct SceneArgs {
    /// The scene: .pbrt, .xml, .ply, .obj, or `gallery:NAME`
    pub scene: Option<PathBuf>,
    /// Give a value to a parameter of the scene file (`$name` in Mitsuba's format)
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = assignment, help_heading = "Scene")]
    pub define: Vec<(String, String)>,
    /// Change an element: `integrator.max_depth=3`, `sampler.kind=independent`, `camera.fov=30`, `NAME.param=value`
    #[arg(long, value_name = "PATH=VALUE", value_parser = assignment, help_heading = "Scene")]
    pub set: Vec<(String, String)>,
    /// Use another of the scene's cameras, counted from 0
    #[arg(short = 's', long, value_name = "N", default_value_t = 0, help_heading = "Scene")]
    pub camera: usize,
    /// Size of the whole image
    #[arg(long, value_name = "WxH", help_heading = "Scene")]
    pub resolution: Option<Size>,
    /// Render a part: fractions of the image where all are within 0 to 1, else pixels
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true, help_heading = "Scene")]
    pub crop: Option<Corners>,
    /// The same in pbrt's order, always as fractions
    #[arg(long = "cropwindow", value_name = "X0,X1,Y0,Y1", conflicts_with = "crop", hide = true)]
    pub crop_window: Option<Corners>,
    /// Treat warnings as errors
    #[arg(long, help_heading = "Scene")]
    pub strict: bool,
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// What a file may ask for.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct LimitArgs {
    /// Pixels of an image, rendered or read
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_pixels: Option<u64>,
    /// Bytes of a file after unpacking
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_file_bytes: Option<u64>,
    /// Vertices or triangles of a mesh
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_mesh_elements: Option<u64>,
    /// Includes within includes
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_include_depth: Option<usize>,
    /// Files that a scene's text is spread over, as often as they are included
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_files: Option<u64>,
    /// Objects within objects, textures or materials that refer to each other
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_nesting: Option<usize>,
    /// Parameters of one element
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_params: Option<usize>,
    /// Textures or materials that one of them asks when it is evaluated
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_evaluations: Option<u64>,
    /// Bytes that a packed byte may unpack to, in large files
    #[arg(long, value_name = "N", help_heading = "Limits")]
    pub max_unpack_ratio: Option<u64>,
    /// Memory that the render may take by estimate, such as 4GiB [default: what is free]
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Limits")]
    pub memory_limit: Option<u64>,
}

/// How loud to be.
#[derive(Args, Clone, Copy, Debug, Default)]
pub(crate) struct Loudness {
    /// Say nothing but errors
    #[arg(short, long, help_heading = "Messages", conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more: all warnings, where the time goes; -vv what is done, -vvv everything
    #[arg(short, long, action = ArgAction::Count, help_heading = "Messages")]
    pub verbose: u8,
}

/// `aureole render`
#[derive(Args, Debug, Default)]
#[command(after_help = "Examples:
  aureole render                               the Cornell box, to cornell-box.png
  aureole render scene.pbrt -o scene.exr --spp 256
  aureole render scene.xml --time 60 -D angle=30 --set integrator.max_depth=5
  aureole render bunny.ply --resolution 1280x720 --tone agx --exposure 1
  aureole render scene.xml --crop 0.4,0.4,0.6,0.6 -o - > detail.png
  aureole render gallery:glass --integrator whitted --stats json
  aureole render scene.pbrt -o scene.exr --checkpoint scene.film.exr --resume
  aureole render scene.pbrt --spp 4096 --shard 3/16 -o part-3.exr")]
pub(crate) struct RenderArgs {
    /// The image; `-` is standard output [default: the scene's own name for it, else SCENE.png here]
    #[arg(short, long, value_name = "FILE", visible_alias = "outfile", help_heading = "Image")]
    pub output: Option<PathBuf>,
    /// Format of standard output: exr, png, jpg, hdr, pfm, ppm [default: png]
    #[arg(long, value_name = "FORMAT", value_parser = image_format, help_heading = "Image")]
    pub format: Option<Format>,
    /// Make the image brighter (eight-bit formats): each stop doubles it
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = 0.0,
        allow_hyphen_values = true,
        help_heading = "Image"
    )]
    pub exposure: f32,
    /// Curve from radiance to display (eight-bit formats)
    #[arg(long, default_value = "srgb", help_heading = "Image")]
    pub tone: Tone,
    /// Samples a pixel [default: the scene's, or as many as fit into --time]
    #[arg(long, value_name = "N", help_heading = "Sampling",
        value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Stop after this time
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = "Sampling")]
    pub time: Option<Duration>,
    /// Another seed draws other samples
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Sampling")]
    pub seed: u64,
    /// Render the I-th of N parts of the samples, counted from 0, to a film for `aureole merge`
    #[arg(long, value_name = "I/N", conflicts_with = "samples", help_heading = "Long renders")]
    pub shard: Option<Shard>,
    /// Render these samples of every pixel, to a film for `aureole merge`
    #[arg(long, value_name = "A..B", value_parser = range, help_heading = "Long renders")]
    pub samples: Option<Range<u32>>,
    /// Keep what is done in this file, written now and then, at the end, and on Ctrl-C
    #[arg(long, value_name = "FILE", help_heading = "Long renders")]
    pub checkpoint: Option<PathBuf>,
    /// Time between two checkpoints, such as 90s, 5min, 1h
    #[arg(long, value_name = "TIME", value_parser = seconds, default_value = "60s", requires = "checkpoint",
        help_heading = "Long renders")]
    pub every: Duration,
    /// Go on from the checkpoint, if it is there
    #[arg(long, requires = "checkpoint", help_heading = "Long renders")]
    pub resume: bool,
    /// Side of the squares that threads work on, in pixels; the image is the same
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1024),
        help_heading = "Sampling")]
    pub tile: u32,
    /// Threads; 0 is one for each processor
    #[arg(
        short,
        long,
        value_name = "N",
        default_value_t = 0,
        visible_alias = "nthreads",
        help_heading = "Sampling"
    )]
    pub threads: usize,
    /// Algorithm, instead of the scene's
    #[arg(long, value_name = "NAME", value_parser = integrators(), help_heading = "Sampling")]
    pub integrator: Option<String>,
    /// How colour travels
    #[arg(long, default_value = "rgb", help_heading = "Sampling")]
    pub color: Color,
    /// Render nothing: print how one sample of a pixel comes about, vertex by vertex (sample 0 unless given)
    #[arg(long, value_name = "X,Y[,SAMPLE]", help_heading = "Messages")]
    pub debug_pixel: Option<PixelArg>,
    /// Messages, progress and log as JSON objects, one a line, on standard error
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
    /// Print figures on standard output when done, instead of a line on standard error
    #[arg(long, value_name = "FORMAT", help_heading = "Messages")]
    pub stats: Option<StatsFormat>,
    #[command(flatten)]
    pub loudness: Loudness,
    #[command(flatten)]
    pub scene: SceneArgs,
}

/// `aureole info`
#[derive(Args, Debug)]
#[command(arg_required_else_help = true)]
#[command(after_help = "Examples:
  aureole info scene.pbrt
  aureole info scene.xml --accel
  aureole info gallery:cornell-box --json")]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Show figures about the acceleration structure
    #[arg(long)]
    pub accel: bool,
    #[command(flatten)]
    pub loudness: Loudness,
}

/// `aureole list`
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  aureole list                                 every element in a line
  aureole list bsdf                            materials with all their parameters
  aureole list rough_conductor                 one element
  aureole list --json")]
pub(crate) struct ListArgs {
    /// A family (shape, bsdf, texture, light, camera, filter, sampler, integrator ...) or the name of an element
    pub family: Option<String>,
    /// Print a JSON array
    #[arg(long)]
    pub json: bool,
}

/// `aureole merge`
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  aureole merge part-*.exr -o scene.exr
  aureole merge part-*.exr -o scene.png --tone agx")]
pub(crate) struct MergeArgs {
    /// Films: of `render --shard` or `--samples`, or checkpoints
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,
    /// The image
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Make the image brighter (eight-bit formats): each stop doubles it
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Curve from radiance to display (eight-bit formats)
    #[arg(long, default_value = "srgb")]
    pub tone: Tone,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `aureole diff`
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  aureole diff reference.exr image.exr
  aureole diff reference.exr image.exr --metric mse --fail-above 1e-3
  aureole diff reference.png image.png -o flip.png
  aureole diff mean.exr image.exr --ztest variance.exr --spp 64")]
pub(crate) struct DiffArgs {
    /// The reference
    pub reference: PathBuf,
    /// The image that is measured
    pub image: PathBuf,
    /// What `--fail-above` looks at and `--output` shows
    #[arg(long, default_value = "flip")]
    pub metric: Metric,
    /// End with code 1 if the metric is above this
    #[arg(long, value_name = "X")]
    pub fail_above: Option<f64>,
    /// Write a picture of the errors
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Test whether noise explains the differences; the file has the variance of one sample
    #[arg(long, value_name = "VARIANCE", requires = "spp")]
    pub ztest: Option<PathBuf>,
    /// Samples a pixel of the image, for the test
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub spp: Option<u64>,
    /// Make both brighter before they are seen (PSNR, FLIP): each stop doubles them
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f32,
    /// Curve by which both are seen (PSNR, FLIP)
    #[arg(long, default_value = "srgb")]
    pub tone: Tone,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `aureole gallery`
#[derive(Args, Debug)]
#[command(after_help = "Examples:
  aureole gallery                              what there is
  aureole gallery glass > glass.xml            a scene to start from
  aureole gallery glass -o pictures            render one to pictures/glass.png
  aureole gallery -o pictures --spp 16         render all")]
pub(crate) struct GalleryArgs {
    /// The scene to show, or to render
    pub name: Option<String>,
    /// Render into this folder
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Samples a pixel [default: each scene's]
    #[arg(long, value_name = "N", requires = "output", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Print the list as a JSON array; with `-o`, messages and progress as JSON objects on standard error
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub loudness: Loudness,
}

/// Curves from radiance to display.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Tone {
    /// sRGB's own; clips what is brighter than white
    #[default]
    Srgb,
    /// Film-like shoulder and toe
    Filmic,
    /// AgX: bright colours fade to white
    Agx,
    /// None: clipped linear values
    Linear,
}

impl From<Tone> for ToneCurve {
    fn from(tone: Tone) -> Self {
        match tone {
            Tone::Srgb => Self::Srgb,
            Tone::Filmic => Self::Filmic,
            Tone::Agx => Self::Agx,
            Tone::Linear => Self::Linear,
        }
    }
}

/// What radiance is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    /// Red, green and blue
    #[default]
    Rgb,
    /// Wavelengths (not yet)
    Spectral,
}

/// How figures are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StatsFormat {
    /// One JSON object in one line
    Json,
}

/// Measures of difference for which more is worse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Metric {
    /// Mean squared error
    Mse,
    /// Mean squared error relative to the reference
    #[value(alias = "rel-mse")]
    Relmse,
    /// Mean absolute error
    Mae,
    /// Largest absolute error
    Max,
    /// What an eye notices when the pictures alternate
    Flip,
}

/// Pixels across and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub width: u32,
    pub height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.trim().parse().ok().filter(|n| (1..=1 << 20).contains(n));
        let sides = text.split_once(['x', 'X', '×']).map(|(width, height)| (side(width), side(height)));
        match sides {
            Some((Some(width), Some(height))) => Ok(Self { width, height }),
            _ => Err("it must look like 640x480".to_owned()),
        }
    }
}

/// A pixel of the whole image, and one of its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PixelArg {
    pub x: u32,
    pub y: u32,
    pub sample: u32,
}

impl FromStr for PixelArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[x, y]) => Ok(Self { x, y, sample: 0 }),
            Ok(&[x, y, sample]) => Ok(Self { x, y, sample }),
            _ => Err("it must look like 12,40 or 12,40,3".to_owned()),
        }
    }
}

/// One of several parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    pub index: u32,
    pub count: u32,
}

impl Shard {
    /// Its share of some samples.
    pub(crate) fn of(self, spp: u32) -> Range<u32> {
        let bound = |i: u32| (u64::from(spp) * u64::from(i) / u64::from(self.count)) as u32;
        bound(self.index)..bound(self.index + 1)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(index, count)| (index.parse(), count.parse()));
        match numbers {
            Some((Ok(index), Ok(count))) if index < count => Ok(Self { index, count }),
            _ => Err("it must look like 0/4 to 3/4: parts are counted from 0".to_owned()),
        }
    }
}

fn range(text: &str) -> Result<Range<u32>, String> {
    match text.split_once("..").map(|(start, end)| (start.parse(), end.parse())) {
        Some((Ok(start), Ok(end))) if start < end => Ok(start..end),
        _ => Err("it must look like 0..64; `--spp` is the number of samples of the whole".to_owned()),
    }
}

/// Four numbers that bound a part of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corners(pub [f64; 4]);

impl FromStr for Corners {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        let numbers = numbers.ok().and_then(|list| <[f64; 4]>::try_from(list).ok());
        let finite = numbers.filter(|list| list.iter().all(|x| x.is_finite() && *x >= 0.0));
        finite.map(Self).ok_or_else(|| "it must be four numbers with commas between them".to_owned())
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_owned(), value.to_owned())),
        _ => Err("it must look like name=value".to_owned()),
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let units = [("ms", 1e-3), ("min", 60.0), ("m", 60.0), ("h", 3600.0), ("s", 1.0)];
    let unit = units.iter().find_map(|(name, unit)| Some((text.strip_suffix(name)?, *unit)));
    let (number, unit) = unit.unwrap_or((text, 1.0));
    let seconds = number.trim().parse().ok().filter(|&x: &f64| x > 0.0);
    seconds
        .and_then(|x| Duration::try_from_secs_f64(x * unit).ok())
        .ok_or_else(|| "it must be a positive time, such as 90, 90s, 5min or 1h".to_owned())
}

/// A number of bytes: `500MB`, `4GiB`, `4g`.
fn bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let unit = unit.trim().to_lowercase();
    let size = ["", "k", "m", "g", "t"]
        .iter()
        .position(|prefix| [prefix.to_string(), format!("{prefix}b"), format!("{prefix}ib")].contains(&unit));
    let base: f64 = if unit.len() == 2 { 1000.0 } else { 1024.0 };
    match (number.parse::<f64>(), size) {
        (Ok(number), Some(power)) if number > 0.0 => Ok((number * base.powi(power as i32)) as u64),
        _ => Err("it must look like 4GiB, 500MB or 2g".to_owned()),
    }
}

fn image_format(text: &str) -> Result<Format, String> {
    let format = Format::from_suffix(text.trim_start_matches('.')).map_err(|error| error.to_string())?;
    format.writable().then_some(format).ok_or_else(|| format!("`{text}` files can be read, not written"))
}

fn integrators() -> PossibleValuesParser {
    aureole::render::integrators().iter().map(|integrator| integrator.kind).collect::<Vec<_>>().into()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn bytes_have_units() {
        assert_eq!(bytes("4GiB"), Ok(4 << 30));
        assert_eq!(bytes("1.5k"), Ok(1536));
        assert_eq!(bytes("500 MB"), Ok(500_000_000));
        assert_eq!(bytes("123"), Ok(123));
        assert!(bytes("4 potatoes").is_err() && bytes("-4G").is_err() && bytes("").is_err());
    }

    #[test]
    fn times_shards_and_ranges_are_read() {
        assert_eq!(seconds("2.5"), Ok(Duration::from_millis(2500)));
        assert_eq!(seconds("5min"), Ok(Duration::from_secs(300)));
        assert_eq!(seconds("20ms"), Ok(Duration::from_millis(20)));
        assert!(seconds("-1s").is_err() && seconds("soon").is_err());
        assert_eq!("1/3".parse(), Ok(Shard { index: 1, count: 3 }));
        assert!("3/3".parse::<Shard>().is_err() && "1".parse::<Shard>().is_err());
        let parts: Vec<_> = (0..3).map(|index| Shard { index, count: 3 }.of(u32::MAX)).collect();
        assert!(parts[0].start == 0 && parts[0].end == parts[1].start && parts[2].end == u32::MAX);
        assert_eq!(range("3..5"), Ok(3..5));
        assert!(range("5..3").is_err() && range("5").is_err());
    }

    #[test]
    fn sizes_and_corners_are_read() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        assert!("640".parse::<Size>().is_err() && "0x4".parse::<Size>().is_err());
        assert_eq!("0,0.25,1,0.75".parse(), Ok(Corners([0.0, 0.25, 1.0, 0.75])));
        assert_eq!("3,4".parse(), Ok(PixelArg { x: 3, y: 4, sample: 0 }));
        assert_eq!("3, 4, 5".parse(), Ok(PixelArg { x: 3, y: 4, sample: 5 }));
        assert!("3".parse::<PixelArg>().is_err() && "3,-4".parse::<PixelArg>().is_err());
        assert!("0,1,2".parse::<Corners>().is_err() && "-1,0,1,1".parse::<Corners>().is_err());
    }
}
