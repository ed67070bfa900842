//! `aureole diff`: how far an image is from a reference.

use std::fmt::Write;
use std::path::Path;

use aureole::image::metric::{self, Colormap, ErrorMap, Errors, PIXELS_PER_DEGREE, ZTest};
use aureole::image::{Image, ImageLimits, ToneMapping, WriteOptions, read_image};
use serde::Serialize;

use crate::args::{DiffArgs, Metric};
use crate::exit::{Exit, Failure};
use crate::output::{Output, print};

/// What is measured.
#[derive(Debug, Serialize)]
struct Measures {
    mse: f64,
    relmse: f64,
    mae: f64,
    max: f64,
    /// Absent for equal images: it would be infinite.
    psnr: Option<f64>,
    flip: f64,
    mean_ratio: f64,
    non_finite: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    ztest: Option<ZTestMeasures>,
}

#[derive(Debug, Serialize)]
struct ZTestMeasures {
    accepted: f64,
    non_finite: usize,
    passes: bool,
}

/// Runs the command.
pub(crate) fn run(args: &DiffArgs) -> Result<Exit, Failure> {
    let output = args.output.as_deref().map(|path| Output::new(path, None)).transpose()?;
    output.iter().try_for_each(Output::check)?;
    let (reference, image) = (read(&args.reference)?, read(&args.image)?);
    let tone = ToneMapping { exposure: args.exposure, curve: args.tone.into(), ..ToneMapping::default() };

    let errors = metric::compare(&reference, &image)?;
    let psnr = metric::psnr(&reference, &image, &tone)?;
    let flip = metric::flip(&reference, &image, &tone, PIXELS_PER_DEGREE)?;
    let ztest = ztest(args, &reference, &image)?;
    let measures = Measures::new(&errors, psnr, &flip, ztest.as_ref());

    print(if args.json { super::json_line(&measures)? } else { measures.to_text() })?;
    if let Some(output) = output {
        write_map(&output, args.metric, &reference, &image, &flip)?;
    }
    let is_above = args.fail_above.is_some_and(|limit| {
        let value = measures.get(args.metric);
        value.is_nan() || value > limit || measures.non_finite > 0
    });
    let is_rejected = ztest.is_some_and(|test| !test.passes());
    Ok(if is_above || is_rejected { Exit::Failed } else { Exit::Done })
}

fn read(path: &Path) -> Result<Image, Failure> {
    Ok(read_image(path, &ImageLimits::default())?)
}

fn ztest(args: &DiffArgs, reference: &Image, image: &Image) -> Result<Option<ZTest>, Failure> {
    let (Some(variance), Some(spp)) = (&args.ztest, args.spp) else { return Ok(None) };
    Ok(Some(metric::z_test(reference, &read(variance)?, image, spp)?))
}

/// Writes the errors in false colours: FLIP's from 0 to 1, others as far as they go.
fn write_map(
    output: &Output,
    shown: Metric,
    reference: &Image,
    image: &Image,
    flip: &ErrorMap,
) -> Result<(), Failure> {
    let picture = match shown {
        Metric::Flip => flip.to_image(Colormap::Magma, 1.0),
        _ => {
            let map = metric::squared_error_map(reference, image)?;
            map.to_image(Colormap::Magma, map.max())
        }
    };
    output.write(&picture, &WriteOptions::default())
}

impl Measures {
    fn new(errors: &Errors, psnr: f64, flip: &ErrorMap, ztest: Option<&ZTest>) -> Self {
        Self {
            mse: errors.mse,
            relmse: errors.rel_mse,
            mae: errors.mae,
            max: errors.max,
            psnr: psnr.is_finite().then_some(psnr),
            flip: flip.mean(),
            mean_ratio: errors.mean_ratio,
            non_finite: errors.non_finite,
            ztest: ztest.map(|test| ZTestMeasures {
                accepted: test.accepted,
                non_finite: test.non_finite,
                passes: test.passes(),
            }),
        }
    }

    fn get(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Mse => self.mse,
            Metric::Relmse => self.relmse,
            Metric::Mae => self.mae,
            Metric::Max => self.max,
            Metric::Flip => self.flip,
        }
    }

    fn to_text(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{name:<11} {value}"); // writing to a string cannot fail
        };
        line("MSE", format!("{:.6e}", self.mse));
        line("relMSE", format!("{:.6e}", self.relmse));
        line("MAE", format!("{:.6e}", self.mae));
        line("max", format!("{:.6e}", self.max));
        line("PSNR", self.psnr.map_or("infinite".to_owned(), |psnr| format!("{psnr:.2} dB")));
        line("FLIP", format!("{:.6}", self.flip));
        line("mean ratio", format!("{:.6}", self.mean_ratio));
        line("non-finite", self.non_finite.to_string());
        if let Some(test) = &self.ztest {
            let verdict = if test.passes { "passes" } else { "fails" };
            line("z-test", format!("{:.5} accepted: {verdict}", test.accepted));
        }
        text
    }
}
