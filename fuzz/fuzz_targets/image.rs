#![no_main]

aureole_fuzz::reader!("image");
