#![no_main]

aureole_fuzz::reader!("curves");
