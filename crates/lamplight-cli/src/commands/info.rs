//! `lamplight info`: the abilities of this program and this machine.

use crate::device_info::AdapterInfo;
use crate::error::Result;
use crate::gpu;
use crate::output;
use lamplight::{Cells, Method};
use serde_json::{Map, json};

/// Show backends, limits and versions
#[derive(clap::Args, Debug)]
pub struct InfoArgs {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub fn run(args: InfoArgs) -> Result {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let features = vector_features();
    let on_gpu: Vec<_> = gpu::METHODS.iter().map(|m| m.name()).collect();
    let methods: Vec<_> = Method::ALL.iter().map(|m| m.name()).chain(["reference"]).collect();
    if args.json {
        return output::print(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "backends": {
                "cpu": { "threads": threads, "features": features },
                "gpu": { "methods": on_gpu },
            },
            "adapters": gpu::adapters().iter().map(|adapter| {
                let AdapterInfo { name, api, kind, driver, side, times_stages } = adapter;
                json!({
                    "name": name, "api": api, "kind": kind, "driver": driver, "tier": "native",
                    "side": side, "times_stages": times_stages,
                })
            }).collect::<Vec<_>>(),
            "methods": methods,
            "presets": Method::ALL.iter().map(|m| (m.name().to_owned(), json!(m.presets())))
                .collect::<Map<_, _>>(),
            "limits": { "side": Cells::MAX_SIDE, "cells": Cells::MAX_CELLS },
        }));
    }
    let features =
        if features.is_empty() { "no known vector units".into() } else { features.join(", ") };
    let presets: Vec<_> =
        Method::ALL.iter().map(|m| format!("{}: {}", m.name(), m.presets().join(", "))).collect();
    let adapters: Vec<_> = gpu::adapters()
        .iter()
        .map(|adapter| {
            let AdapterInfo { name, api, kind, driver, side, times_stages } = adapter;
            let times = if *times_stages { "times stages" } else { "without times of stages" };
            let about = format!("{kind}, {api}, {driver}");
            format!("{name} ({about}): tier native, up to {side} cells a side, {times}")
        })
        .collect();
    let adapters = if adapters.is_empty() { "none".into() } else { adapters.join("\n          ") };
    output::print(format_args!(
        "lamplight {version}
backends  cpu: {threads} threads, {arch} with {features}
          gpu: {gpu}
adapters  {adapters}
methods   {methods}
presets   {presets}
limits    {side} cells a side, {cells} million cells in all",
        version = env!("CARGO_PKG_VERSION"),
        arch = std::env::consts::ARCH,
        methods = methods.join(", "),
        gpu = if on_gpu.is_empty() { "not in this build".into() } else { on_gpu.join(", ") },
        presets = presets.join("\n          "),
        side = Cells::MAX_SIDE,
        cells = Cells::MAX_CELLS / 1_000_000,
    ))
}

/// The vector units of this processor, best last.
fn vector_features() -> Vec<&'static str> {
    #[cfg(target_arch = "x86_64")]
    return [
        ("sse4.1", is_x86_feature_detected!("sse4.1")),
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("f16c", is_x86_feature_detected!("f16c")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ]
    .into_iter()
    .filter_map(|(name, here)| here.then_some(name))
    .collect();
    #[cfg(target_arch = "aarch64")]
    return vec!["neon"];
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    return Vec::new();
}
