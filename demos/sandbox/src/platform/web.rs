//! Services of a web page: files are downloads, and scripts come from the page.

use super::{Dropped, File, Handover};
use anyhow::{Context as _, Result, anyhow, bail};
use eframe::egui::DroppedFileHandle;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::mpsc::Sender;
use wasm_bindgen::prelude::*;
use web_sys::js_sys::{Array, Uint8Array};
use web_sys::{Blob, Document, HtmlAnchorElement, Url, UrlSearchParams, console};

/// Default columns and rows if light is computed on the CPU, in one thread.
pub const CELLS_ON_CPU: [u32; 2] = [160, 90];

/// False: a page has only the files that it is given, so a scene comes with its images.
pub const HAS_FOLDERS: bool = false;

/// The id of the message in `web/index.html`.
const WORDS: &str = "words";

/// The document of the page.
pub fn document() -> Result<Document> {
    web_sys::window().and_then(|window| window.document()).context("a page has a document")
}

/// Shows a message in the middle of the page; an empty one hides it.
pub fn show_message(words: &str) {
    if let Ok(document) = document()
        && let Some(place) = document.get_element_by_id(WORDS)
    {
        place.set_text_content(Some(words));
    }
}

/// Converts an error of the page.
pub fn page_error(why: JsValue) -> anyhow::Error {
    anyhow!(why.as_string().unwrap_or_else(|| format!("{why:?}")))
}

/// Reads a dropped file, then hands it to the window.
pub fn read_dropped(file: DroppedFileHandle, is_layer: bool, to: Sender<Result<Dropped>>) {
    wasm_bindgen_futures::spawn_local(async move {
        let path = file.path().to_owned();
        let read = file.bytes_async().await;
        let read = read.map(|bytes| Dropped { path, bytes: Some(bytes), is_layer });
        let read = read.map_err(|why| anyhow!("cannot read {}: {why}", file.path().display()));
        // The window that receives it may be closed.
        let _ = to.send(read);
    });
}

/// Offers files as downloads.
pub fn save(files: &[File]) -> Result<String> {
    for (name, bytes) in files {
        download(name, bytes)
            .map_err(page_error)
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

/// Logs a line for the person who runs the script.
pub fn say(word: &str) {
    console::log_1(&word.into());
}

thread_local! {
    static SCRIPTS: RefCell<VecDeque<String>> = const { RefCell::new(VecDeque::new()) };
}

/// Queues a script: `lamplight.play` of the page.
#[wasm_bindgen]
pub fn play(script: String) {
    SCRIPTS.with_borrow_mut(|scripts| scripts.push_back(script));
}

/// The next script.
pub fn next_script() -> Option<String> {
    SCRIPTS.with_borrow_mut(VecDeque::pop_front)
}

/// Reloads the page with a world that restarts. A canvas, which would be lost, is downloaded instead.
pub fn hand_over(next: &Handover, _: bool) -> Result<()> {
    if !next.files.is_empty() {
        save(&next.files)?;
        show_message(
            "The GPU was lost. What was painted is among the downloads, as a scene: load this page again \
             and drop its files here, all at once.",
        );
        bail!("what was painted is among the downloads");
    }
    let query = UrlSearchParams::new().map_err(page_error)?;
    for argument in &next.arguments {
        if let Some((name, value)) = argument.trim_start_matches('-').split_once('=') {
            query.set(name, value);
        }
    }
    query.set("script", &next.lines.join("\n"));
    let location = web_sys::window().context("a page has a window")?.location();
    location.set_search(&String::from(query.to_string())).map_err(page_error)
}
