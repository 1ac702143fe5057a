//! A web page: the address says how it begins, files are downloads, scripts come from the page.
//!
//! Light is found and drawn by WebGPU; where there is none, or none that is of use, it is found on
//! the CPU and drawn by WebGL 2.

use super::File;
use crate::window::anew::Anew;
use crate::window::light::Backend;
use crate::window::{App, Start, check, device};
use anyhow::{Context as _, Result, anyhow, bail};
use clap::{CommandFactory, Parser};
use eframe::egui_wgpu::WgpuConfiguration;
use eframe::{Renderer, WebLogger, WebOptions, WebRunner};
use lamplight_wgpu::Tier;
use std::cell::RefCell;
use std::collections::VecDeque;
use wasm_bindgen::prelude::*;
use web_sys::js_sys::{Array, Uint8Array};
use web_sys::{
    Blob, Document, HtmlAnchorElement, HtmlCanvasElement, Url, UrlSearchParams, console,
};

/// Cells to begin with where light is found on the CPU: one thread of it.
pub const CELLS_ON_CPU: [u32; 2] = [160, 90];

/// Ids in `web/index.html`.
const CANVAS: &str = "picture";
const WORDS: &str = "words";

#[wasm_bindgen(module = "/web/gpu.js")]
extern "C" {
    /// Why WebGPU is of no use here; empty where it is.
    #[wasm_bindgen(js_name = whyNoGpu)]
    async fn why_no_gpu() -> JsValue;
}

/// What the address may say, as `?world=sand&size=320x180`.
#[derive(Parser, Debug)]
struct Query {
    #[command(flatten)]
    start: Start,
}

/// Starts the page, and comes back at once.
pub fn run() -> Result<()> {
    // It is the only logger there is.
    let _ = WebLogger::init(log::LevelFilter::Warn);
    wasm_bindgen_futures::spawn_local(async {
        let told = open().await.err().map(|why| format!("{why:#}"));
        tell(told.as_deref().unwrap_or_default());
    });
    Ok(())
}

async fn open() -> Result<()> {
    let runner = WebRunner::new();
    let known = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |what| {
        tell(&format!("lamplight broke: {what}. To start again, load this page again."));
        known(what);
    }));
    let (mut start, mut told) = query()?;
    if start.backend != Backend::Cpu {
        let why = match start.backend {
            Backend::Gpu => None,
            _ => why_no_gpu().await.as_string().filter(|why| !why.is_empty()),
        };
        let why = match why {
            Some(why) => why,
            None => match show(&runner, Renderer::Wgpu, &start, &told).await {
                Ok(()) => return Ok(()),
                Err(why) => format!("WebGPU cannot be used ({why:#})"),
            },
        };
        told.push(format!("{why}: light is found on the CPU, with fewer cells."));
        new_canvas()?;
    }
    start.backend = Backend::Cpu;
    show(&runner, Renderer::Glow, &start, &told).await.context(
        "This browser can show neither WebGPU nor WebGL 2; another one, or a newer one, may",
    )
}

/// Shows the window on the canvas of the page.
async fn show(
    runner: &WebRunner,
    renderer: Renderer,
    start: &Start,
    told: &[String],
) -> Result<()> {
    let options = WebOptions {
        renderer,
        wgpu_options: WgpuConfiguration {
            wgpu_setup: device(Tier::Web),
            ..WgpuConfiguration::default()
        },
        ..WebOptions::default()
    };
    let (start, told) = (start.clone(), told.join(" "));
    let begin = move |context: &eframe::CreationContext| {
        let mut app = App::new(context, &start, None)?;
        app.say(Ok(Some(told).filter(|told| !told.is_empty())));
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    let canvas = canvas()?;
    runner.start(canvas.clone(), options, Box::new(begin)).await.map_err(told_by_page)?;
    // Keys work at once.
    canvas.focus().map_err(told_by_page)
}

/// What the address says, and what is wrong with it.
fn query() -> Result<(Start, Vec<String>)> {
    let window = web_sys::window().context("a page has a window")?;
    let text = window.location().search().map_err(told_by_page)?;
    let pairs = UrlSearchParams::new_with_str(&text).map_err(told_by_page)?;
    if let Some(script) = pairs.get("script") {
        play(script);
    }
    let (mut given, mut told) = (vec!["lamplight".to_owned()], Vec::new());
    for known in Query::command().get_arguments() {
        let name = known.get_id().as_str();
        let Some(value) = pairs.get(name) else { continue };
        // With those before it: a world has sizes that it can be.
        let with = [&given[..], &[format!("--{name}={value}")]].concat();
        match Query::try_parse_from(&with) {
            Ok(query) => match check(&query.start) {
                Ok(()) => given = with,
                Err(why) => told.push(format!("{name}={value} is left out: {why}.")),
            },
            Err(why) => {
                let why = why.to_string();
                let why = why.split("\n\n").next().unwrap_or_default();
                let words: Vec<&str> = why.split_whitespace().skip(1).collect();
                told.push(format!("{name}={value} is left out: {}.", words.join(" ")));
            }
        }
    }
    Ok((Query::try_parse_from(given)?.start, told))
}

fn document() -> Result<Document> {
    web_sys::window().and_then(|window| window.document()).context("a page has a document")
}

fn canvas() -> Result<HtmlCanvasElement> {
    let found = document()?.get_element_by_id(CANVAS).context("the page has no canvas")?;
    found.dyn_into().map_err(|_| anyhow!("what the page calls its canvas is none"))
}

/// Puts a new canvas in the place of the old one, which WebGPU may have taken.
fn new_canvas() -> Result<()> {
    let old = canvas()?;
    let new = old.clone_node().map_err(told_by_page)?;
    old.replace_with_with_node_1(&new).map_err(told_by_page)
}

/// Says something in the middle of the page, or nothing any more.
fn tell(words: &str) {
    if let Ok(document) = document()
        && let Some(place) = document.get_element_by_id(WORDS)
    {
        place.set_text_content(Some(words));
    }
}

fn told_by_page(why: JsValue) -> anyhow::Error {
    anyhow!(why.as_string().unwrap_or_else(|| format!("{why:?}")))
}

/// Offers files as downloads.
pub fn save(files: &[File]) -> Result<String> {
    for (name, bytes) in files {
        download(name, bytes)
            .map_err(told_by_page)
            .with_context(|| format!("cannot offer {name}"))?;
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    Ok(format!("downloaded {}", names.join(", ")))
}

fn download(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let blob = Blob::new_with_u8_array_sequence(&Array::of1(&Uint8Array::from(bytes)))?;
    let url = Url::create_object_url_with_blob(&blob)?;
    let document = document().map_err(|why| why.to_string())?;
    let anchor: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    anchor.set_href(&url);
    anchor.set_download(name);
    anchor.click();
    Url::revoke_object_url(&url)
}

/// Says a word to who watches a script.
pub fn say(word: &str) {
    console::log_1(&word.into());
}

thread_local! {
    static SCRIPTS: RefCell<VecDeque<String>> = const { RefCell::new(VecDeque::new()) };
}

/// Plays what a script says, after those that were given before: `lamplight.play` of the page.
#[wasm_bindgen]
pub fn play(script: String) {
    SCRIPTS.with_borrow_mut(|scripts| scripts.push_back(script));
}

/// The script that comes next.
pub fn next_script() -> Option<String> {
    SCRIPTS.with_borrow_mut(VecDeque::pop_front)
}

/// Loads the page again, with a world that begins anew; a canvas is offered as downloads, as it would be lost.
pub fn go_on_anew(anew: &Anew, _: bool) -> Result<()> {
    if !anew.files.is_empty() {
        save(&anew.files)?;
        tell(
            "The GPU was lost. What was painted is among the downloads, as a scene: load this page again \
             and drop its files here, all at once.",
        );
        bail!("what was painted is among the downloads");
    }
    let query = UrlSearchParams::new().map_err(told_by_page)?;
    for argument in &anew.arguments {
        if let Some((name, value)) = argument.trim_start_matches('-').split_once('=') {
            query.set(name, value);
        }
    }
    query.set("script", &anew.lines.join("\n"));
    let location = web_sys::window().context("a page has a window")?.location();
    location.set_search(&String::from(query.to_string())).map_err(told_by_page)
}
