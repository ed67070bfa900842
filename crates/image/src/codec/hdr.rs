//! Reading Radiance pictures: a header of text, a line of size and orientation, and scanlines of bytes with a shared
//! exponent. Writing is in `common`.
//!
//! Numbers are taken as they are stored, as other renderers do: `EXPOSURE` is not divided out.
//!
//! [Ward 1991] G. Ward, "Real Pixels", Graphics Gems II; "Radiance File Formats", section "Picture File Format".

use aureole_spectrum::Primaries;

use super::Probe;
use crate::ImageLimits;
use crate::error::Fault;
use crate::raster::{Orientation, Raster, Texels};

/// A run of old files can be as long as it likes, so a size is only believed of a file that is long enough.
const MAX_PIXELS_PER_BYTE: u64 = 1 << 13;
/// Scanlines of other widths are never packed in the new way.
const PACKED_WIDTHS: std::ops::Range<usize> = 8..32_768;

struct Header {
    /// Scanlines, and pixels in each.
    count: u64,
    length: u64,
    orientation: Orientation,
    /// What the three numbers mean, where the file says it.
    primaries: Option<Primaries>,
    /// Where the pixels start.
    end: usize,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        let mut end = 0;
        let mut primaries = None;
        let mut next_line = || {
            let rest = &bytes[end..];
            let length = rest.iter().position(|&b| b == b'\n')?;
            end += length + 1;
            Some(String::from_utf8_lossy(&rest[..length]).trim_end_matches('\r').to_owned())
        };
        let cut = || Fault::content("its header has no end");
        loop {
            let line = next_line().ok_or_else(cut)?;
            if line.is_empty() {
                break;
            }
            match line.split_once('=').map(|(name, value)| (name.trim(), value.trim())) {
                Some(("FORMAT", "32-bit_rle_rgbe")) => {}
                Some(("FORMAT", "32-bit_rle_xyze")) => primaries = Some(Primaries::XYZ),
                Some(("FORMAT", other)) => {
                    return Err(Fault::content(format!("`{other}` is not a format of its numbers")));
                }
                Some(("PRIMARIES", list)) => primaries = parse_primaries(list).or(primaries),
                _ => {}
            }
        }
        let size = next_line().ok_or_else(cut)?;
        let (count, length, orientation) = parse_size(&size)
            .ok_or_else(|| Fault::content(format!("{size:?} is not a size such as `-Y 480 +X 640`")))?;
        Ok(Self { count, length, orientation, primaries, end })
    }

    fn size(&self) -> [u64; 2] {
        if self.orientation.transpose { [self.count, self.length] } else { [self.length, self.count] }
    }
}

/// `-Y 480 +X 640`: how many scanlines there are and which way they follow each other, and the same for the pixels in each.
fn parse_size(line: &str) -> Option<(u64, u64, Orientation)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [major, count, minor, length] = words[..] else { return None };
    let transpose = match (major.get(1..)?, minor.get(1..)?) {
        ("Y", "X") => false,
        ("X", "Y") => true,
        _ => return None,
    };
    let is_known = |axis: &str| axis.starts_with(['+', '-']);
    if !is_known(major) || !is_known(minor) {
        return None;
    }
    let (x, y) = if transpose { (major, minor) } else { (minor, major) };
    // Y points up and X to the right.
    let orientation = Orientation { transpose, flip_x: x.starts_with('-'), flip_y: y.starts_with('+') };
    Some((count.parse().ok()?, length.parse().ok()?, orientation))
}

/// Chromaticities of red, green, blue and white.
fn parse_primaries(list: &str) -> Option<Primaries> {
    let numbers: Vec<f64> = list.split_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let [rx, ry, gx, gy, bx, by, wx, wy] = numbers[..] else { return None };
    Some(Primaries { colors: [[rx, ry], [gx, gy], [bx, by]], white: [wx, wy] })
}

/// The size of a picture by its first bytes.
pub(super) fn probe(start: &[u8]) -> Option<Probe> {
    let [width, height] = Header::parse(start).ok()?.size();
    Some(Probe { width, height, bytes_per_pixel: 12 })
}

pub(super) fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
    let header = Header::parse(bytes)?;
    let size = limits.check(header.length, header.count, 3, 4)?;
    if header.length * header.count > MAX_PIXELS_PER_BYTE.saturating_mul(bytes.len() as u64) {
        return Err(Fault::content(format!("{} bytes cannot hold its pixels", bytes.len())));
    }
    let (length, count) = (header.length as usize, header.count as usize);
    let mut line = vec![[0; 4]; length];
    let mut data = Vec::with_capacity(size);
    let mut rest = &bytes[header.end..];
    for row in 0..count {
        rest = scanline(rest, &mut line)
            .ok_or_else(|| Fault::content(format!("it ends, or is broken, in line {row} of {count}")))?;
        data.extend(line.iter().flat_map(|&texel| decode_texel(texel)));
    }
    let mut raster = Raster::picture(length, count, 3, Texels::Floats(data));
    if let Some(primaries) = header.primaries {
        raster.convert_primaries(primaries);
    }
    Ok(raster.oriented(header.orientation))
}

/// Three numbers of eight bits times two to the power of the fourth.
fn decode_texel([r, g, b, exponent]: [u8; 4]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let scale = libm::ldexpf(1.0, i32::from(exponent) - (128 + 8));
    [r, g, b].map(|mantissa| f32::from(mantissa) * scale)
}

/// Reads one scanline; gives the bytes after it.
fn scanline<'a>(bytes: &'a [u8], line: &mut [[u8; 4]]) -> Option<&'a [u8]> {
    match bytes {
        &[2, 2, high, low, ref rest @ ..] if PACKED_WIDTHS.contains(&line.len()) && high < 128 => {
            let is_width = usize::from(u16::from_be_bytes([high, low])) == line.len();
            if is_width { packed_scanline(rest, line) } else { None }
        }
        _ => plain_scanline(bytes, line),
    }
}

/// All reds, then all greens and so on, each as runs of one byte or stretches of several.
fn packed_scanline<'a>(mut bytes: &'a [u8], line: &mut [[u8; 4]]) -> Option<&'a [u8]> {
    for component in 0..4 {
        let mut x = 0;
        while x < line.len() {
            let (&code, rest) = bytes.split_first()?;
            let is_run = code > 128;
            let count = usize::from(if is_run { code - 128 } else { code });
            let (values, rest) = rest.split_at_checked(if is_run { 1 } else { count })?;
            let target = line.get_mut(x..x + count).filter(|target| !target.is_empty())?;
            for (i, texel) in target.iter_mut().enumerate() {
                texel[component] = values[if is_run { 0 } else { i }];
            }
            (x, bytes) = (x + count, rest);
        }
    }
    Some(bytes)
}

/// Pixels one by one. In old files one of 1, 1, 1 and a count repeats the last; counts that follow each other are digits, the
/// lowest first.
fn plain_scanline<'a>(mut bytes: &'a [u8], line: &mut [[u8; 4]]) -> Option<&'a [u8]> {
    let (mut x, mut shift) = (0, 0);
    while x < line.len() {
        let (&texel, rest) = bytes.split_first_chunk::<4>()?;
        bytes = rest;
        if let [1, 1, 1, count] = texel
            && x > 0
        {
            let count = usize::from(count).checked_shl(shift)?;
            let last = line[x - 1];
            line.get_mut(x..x.checked_add(count)?)?.fill(last);
            (x, shift) = (x + count, shift + 8);
        } else {
            line[x] = texel;
            (x, shift) = (x + 1, 0);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.5, 0.25, 1.5 and its half.
    const BRIGHT: [u8; 4] = [64, 32, 192, 129];
    const DIM: [u8; 4] = [64, 32, 192, 128];

    fn file(header: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
        [header.as_bytes(), pixels.as_flattened()].concat()
    }

    fn read(bytes: &[u8]) -> crate::Image {
        decode(bytes, &ImageLimits::default()).unwrap().into_image().unwrap()
    }

    #[test]
    fn any_signature_and_line_ending_will_do() {
        for header in [
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n",
            "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n",
            "#?AUTOPANO\r\n# made by hand\r\nEXPOSURE=2\r\n\r\n-Y 1 +X 2\r\n",
        ] {
            let image = read(&file(header, &[BRIGHT, DIM]));
            assert_eq!(image.data(), [0.5, 0.25, 1.5, 0.25, 0.125, 0.75], "{header}");
        }
        for header in ["#?RGBE\nFORMAT=64-bit\n\n-Y 1 +X 2\n", "#?RGBE\n\n-Y 1 +Z 2\n", "#?RGBE\n-Y 1 +X 2\n"]
        {
            assert!(decode(&file(header, &[BRIGHT, DIM]), &ImageLimits::default()).is_err(), "{header}");
        }
    }

    /// A bright pixel at the left end of the upper row, as each of the eight orientations stores it.
    #[test]
    fn pictures_lie_the_way_the_file_says() {
        for (size, place) in [
            ("-Y 2 +X 3", 0),
            ("-Y 2 -X 3", 2),
            ("+Y 2 +X 3", 3),
            ("+Y 2 -X 3", 5),
            ("+X 3 -Y 2", 0),
            ("+X 3 +Y 2", 1),
            ("-X 3 -Y 2", 4),
            ("-X 3 +Y 2", 5),
        ] {
            let mut pixels = [DIM; 6];
            pixels[place] = BRIGHT;
            let image = read(&file(&format!("#?RADIANCE\n\n{size}\n"), &pixels));
            assert_eq!((image.width(), image.height()), (3, 2), "{size}");
            let bright: Vec<_> = (0..6).filter(|i| image.rgb(i % 3, i / 3)[0] > 0.4).collect();
            assert_eq!(bright, [0], "{size}");
        }
    }

    #[test]
    fn runs_of_old_and_new_files_are_unpacked() {
        // Three pixels by a run of old, whose second digit is 0.
        let old = file("#?RADIANCE\n\n-Y 1 +X 4\n", &[BRIGHT, [1, 1, 1, 2], DIM]);
        assert_eq!(read(&old).plane(0).collect::<Vec<_>>(), [0.5, 0.5, 0.5, 0.25]);
        let mut new = file("#?RADIANCE\n\n-Y 1 +X 8\n", &[[2, 2, 0, 8]]);
        new.extend([128 + 8, 64, 128 + 8, 32, 128 + 8, 192, 128 + 6, 129, 2, 128, 129]);
        let image = read(&new);
        assert_eq!(image.plane(2).collect::<Vec<_>>(), [1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 0.75, 1.5]);
        for end in 0..new.len() {
            assert!(decode(&new[..end], &ImageLimits::default()).is_err());
        }
    }

    /// The white of equal energy is white, and a colour of XYZ is that of Rec. 709.
    #[test]
    fn xyz_becomes_rgb() {
        let header = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n";
        let white = read(&file(header, &[[128, 128, 128, 129]]));
        assert!(white.rgb(0, 0).iter().all(|x| (x - 1.0).abs() < 1e-5), "{:?}", white.rgb(0, 0));
        let [r, g, b] = read(&file(header, &[[128, 64, 0, 129]])).rgb(0, 0);
        assert!(r > 1.5 && g < 0.1 && b < 0.1, "{r} {g} {b}");
    }
}
