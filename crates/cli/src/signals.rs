//! Ctrl-C and requests to end.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::exit::Exit;

/// Notices signals from its creation on. While there is nothing to lose they end the program at once; after
/// [`be_patient`](Self::be_patient) the first one only asks to stop.
#[derive(Clone, Debug)]
pub(crate) struct Signals {
    received: Arc<AtomicUsize>,
    impatient: Arc<AtomicBool>,
}

impl Signals {
    /// Begins to listen. Where signals cannot be had, nothing is noticed.
    pub(crate) fn listen() -> Self {
        let received = Arc::new(AtomicUsize::new(0));
        let impatient = Arc::new(AtomicBool::new(true));
        for (signal, exit) in [(SIGINT, Exit::Interrupted), (SIGTERM, Exit::Terminated)] {
            // In this order: the first signal that finds `impatient` unset sets it.
            let _ = flag::register_conditional_shutdown(signal, exit as i32, impatient.clone());
            let _ = flag::register(signal, impatient.clone());
            let _ = flag::register_usize(signal, received.clone(), signal as usize);
        }
        Self { received, impatient }
    }

    /// From now on there is work to be kept.
    pub(crate) fn be_patient(&self) {
        self.impatient.store(false, Ordering::Relaxed);
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
