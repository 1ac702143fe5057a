//! `lamplight info`: the abilities of this program and this machine.

use crate::error::Result;
use crate::gpu::{adapters, times_stages};
use crate::output;
use lamplight::{Cells, Method};
use lamplight_wgpu::wgpu::DeviceType;
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
    let on_gpu: Vec<_> = Method::ALL.iter().map(|m| m.name()).collect();
    let methods: Vec<_> = on_gpu.iter().copied().chain(["reference"]).collect();
    if args.json {
        return output::print(json!({
            "version": env!("CARGO_PKG_VERSION"),
            "backends": {
                "cpu": { "threads": threads, "features": features },
                "gpu": { "methods": on_gpu },
            },
            "adapters": adapters().iter().map(|adapter| {
                let info = adapter.get_info();
                json!({
                    "name": info.name, "api": info.backend.to_str(),
                    "kind": kind(info.device_type), "driver": info.driver_info, "tier": "native",
                    "side": adapter.limits().max_texture_dimension_2d,
                    "times_stages": times_stages(adapter),
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
    let adapters: Vec<_> = adapters()
        .iter()
        .map(|adapter| {
            let info = adapter.get_info();
            let (kind, side) = (kind(info.device_type), adapter.limits().max_texture_dimension_2d);
            let times =
                if times_stages(adapter) { "times stages" } else { "without times of stages" };
            let about = format!("{kind}, {}, {}", info.backend, info.driver_info);
            format!("{} ({about}): tier native, up to {side} cells a side, {times}", info.name)
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
        gpu = on_gpu.join(", "),
        presets = presets.join("\n          "),
        side = Cells::MAX_SIDE,
        cells = Cells::MAX_CELLS / 1_000_000,
    ))
}

fn kind(device: DeviceType) -> &'static str {
    match device {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "software",
        DeviceType::Other => "of another kind",
    }
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
