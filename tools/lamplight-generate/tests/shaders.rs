//! The program prints shaders, as `cargo xtask test --web` reads them.

use serde_json::{Map, Value};
use std::process::Command;

#[test]
fn every_shader_is_printed_by_its_name() {
    let program = env!("CARGO_BIN_EXE_lamplight-generate");
    let printed = Command::new(program).arg("shaders").output().unwrap();
    assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
    let printed: Map<String, Value> = serde_json::from_slice(&printed.stdout).unwrap();
    let shaders: Vec<_> = lamplight_wgpu::shaders().collect();
    assert!(shaders.len() > 40 && printed.len() == shaders.len(), "{} shaders", printed.len());
    for (name, text) in shaders {
        assert_eq!(printed[name], Value::from(text), "{name}");
    }
}
