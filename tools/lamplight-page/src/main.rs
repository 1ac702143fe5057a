//! A web page, put together, weighed and served: `cargo xtask web`.

mod script;
mod serve;
mod weigh;

use anyhow::Result;
use clap::Parser;
use serve::Server;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "lamplight-page", about = "Puts a web page together, weighs and serves it.")]
struct Args {
    /// The page's folder.
    folder: PathBuf,
    /// Add a program, compiled for the web, and the script that runs it.
    #[arg(long, value_name = "WASM", requires = "name")]
    program: Option<PathBuf>,
    /// The name of both on the page.
    #[arg(long, value_name = "NAME", requires = "program")]
    name: Option<String>,
    /// Fail if the page has more bytes than this, compressed as servers send it.
    #[arg(long, value_name = "BYTES")]
    limit: Option<usize>,
    /// Serve it to this machine at this port, 0 for any free one. The address is printed.
    #[arg(long, value_name = "PORT")]
    serve: Option<u16>,
}

fn main() -> ExitCode {
    match run(Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: Args) -> Result<()> {
    if let (Some(program), Some(name)) = (args.program, args.name) {
        script::write(&program, &name, &args.folder)?;
    }
    if let Some(limit) = args.limit {
        weigh::run(&args.folder, limit)?;
    }
    if let Some(port) = args.serve {
        let server = Server::new(args.folder, port)?;
        println!("{}", server.address());
        server.run();
    }
    Ok(())
}
