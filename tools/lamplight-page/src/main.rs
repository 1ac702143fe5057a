//! A web page, weighed and served: `cargo xtask web`.

mod serve;
mod weigh;

use anyhow::Result;
use clap::Parser;
use serve::Server;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "lamplight-page", about = "Weighs a web page, and serves it.")]
struct Args {
    /// The page's folder.
    folder: PathBuf,
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
