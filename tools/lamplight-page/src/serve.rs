//! A folder, served as a web page to this machine alone.

use anyhow::{Result, anyhow};
use std::fs::File;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Component, Path, PathBuf};
use tiny_http::{Header, Request, Response};

/// A server; it ends with the process.
pub struct Server {
    server: tiny_http::Server,
    folder: PathBuf,
    port: u16,
}

impl Server {
    /// At a port, 0 for any free one.
    pub fn new(folder: PathBuf, port: u16) -> Result<Self> {
        let server = tiny_http::Server::http((Ipv4Addr::LOCALHOST, port))
            .map_err(|why| anyhow!("port {port} cannot be served: {why}"))?;
        let port = server.server_addr().to_ip().as_ref().map_or(port, SocketAddr::port);
        Ok(Self { server, folder, port })
    }

    pub fn address(&self) -> String {
        format!("http://localhost:{}/", self.port)
    }

    /// Answers until the process ends.
    pub fn run(&self) {
        for request in self.server.incoming_requests() {
            self.answer(request);
        }
    }

    fn answer(&self, request: Request) {
        let path = request.url().split(['?', '#']).next().unwrap_or_default();
        let path = self.folder.join(if path == "/" { "index.html" } else { &path[1..] });
        // Nothing beside the folder; who hangs up early hears no answer.
        let inside = !path.components().any(|part| part == Component::ParentDir);
        let _ = match File::open(&path).ok().filter(|_| inside && path.is_file()) {
            Some(file) => {
                let mut response = Response::from_file(file);
                for header in [content_type(&path), "Cache-Control: no-store"] {
                    if let Ok(header) = header.parse::<Header>() {
                        response.add_header(header);
                    }
                }
                request.respond(response)
            }
            None => request.respond(Response::from_string("not here").with_status_code(404)),
        };
    }
}

fn content_type(path: &Path) -> &'static str {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "Content-Type: text/html; charset=utf-8",
        Some("js") => "Content-Type: text/javascript; charset=utf-8",
        Some("wasm") => "Content-Type: application/wasm",
        _ => "Content-Type: application/octet-stream",
    }
}
