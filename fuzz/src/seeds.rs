//! Writes the seed corpora: `corpus/TARGET/SAMPLE` for every target.

use std::path::Path;

use aureole_fuzz::{samples, targets};

fn main() -> std::io::Result<()> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for target in targets::ALL {
        let folder = corpus.join(target.name);
        std::fs::create_dir_all(&folder)?;
        for sample in samples::of(target.name) {
            std::fs::write(folder.join(&sample.name), &sample.bytes)?;
        }
    }
    Ok(())
}
