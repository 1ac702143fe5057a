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
        let file = file_of(request.url()).and_then(|path| {
            let path = self.folder.join(path);
            let file = File::open(&path).ok().filter(|_| path.is_file())?;
            Some((file, content_type(&path)))
        });
        // Who hangs up early hears no answer.
        let _ = match file {
            Some((file, content_type)) => {
                let mut response = Response::from_file(file);
                for header in [content_type, "Cache-Control: no-store"] {
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

/// The file that an address means, by its path from the folder; `None` if that leads out of the folder, as `//etc/hosts`
/// would.
fn file_of(url: &str) -> Option<&Path> {
    let path = url.split(['?', '#']).next()?.strip_prefix('/')?;
    let path = Path::new(if path.is_empty() { "index.html" } else { path });
    path.components().all(|part| matches!(part, Component::Normal(_))).then_some(path)
}

fn content_type(path: &Path) -> &'static str {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("html") => "Content-Type: text/html; charset=utf-8",
        Some("js") => "Content-Type: text/javascript; charset=utf-8",
        Some("wasm") => "Content-Type: application/wasm",
        _ => "Content-Type: application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_means_a_file_of_the_folder_or_none() {
        for (url, file) in [
            ("/", "index.html"),
            ("/?world=sand", "index.html"),
            ("/lamplight.js", "lamplight.js"),
            ("/a/b.wasm#c", "a/b.wasm"),
        ] {
            assert_eq!(file_of(url), Some(Path::new(file)), "{url}");
        }
        for url in ["", "?x", "*", "//etc/hosts", "/../a", "/a/../../b", "/..", "http://a/b"] {
            assert_eq!(file_of(url), None, "{url}");
        }
    }
}
