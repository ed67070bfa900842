//! Wavelengths, spectra, CIE data, colour spaces, up-sampling.
