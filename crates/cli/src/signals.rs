//! Ctrl-C and requests to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

/// Notices signals from its creation on. The first one asks to stop; another one ends the program at once.
#[derive(Clone, Debug)]
pub(crate) struct Signals {
    received: Arc<AtomicUsize>,
}

impl Signals {
    /// Begins to listen. Where signals cannot be had, nothing is noticed.
    pub(crate) fn listen() -> Self {
        let received = Arc::new(AtomicUsize::new(0));
        let impatient = Arc::new(AtomicBool::new(false));
        for (signal, exit) in [(SIGINT, Exit::Interrupted), (SIGTERM, Exit::Terminated)] {
            // In this order: the first signal finds `impatient` unset and sets it.
            let _ = flag::register_conditional_shutdown(signal, exit as i32, impatient.clone());
            let _ = flag::register(signal, impatient.clone());
            let _ = flag::register_usize(signal, received.clone(), signal as usize);
        }
        Self { received }
    }

    /// The code to end with after a signal.
    pub(crate) fn received(&self) -> Option<Exit> {
        match self.received.load(Ordering::Relaxed) as i32 {
            SIGINT => Some(Exit::Interrupted),
            SIGTERM => Some(Exit::Terminated),
            _ => None,
        }
    }
}
