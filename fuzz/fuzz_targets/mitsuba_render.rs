#![no_main]

aureole_fuzz::reader!("mitsuba_render");
