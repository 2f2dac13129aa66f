//! A static file server for one machine.
//!
//! The small HTTP libraries for Rust have had no release for years, and the living ones bring an async runtime that
//! takes longer to compile than the rest of xtask. What a page under development needs is little: `GET` and `HEAD` of
//! whole files over HTTP/1.1 with kept-alive connections, right content types, and no caching. It listens on the
//! loopback interface alone and refuses other host names, so no web site can reach it through a rebound name.
//! A thread a connection; a browser opens six.

use anyhow::{Context, Result};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::time::Duration;

/// The longest request head that is read, in bytes.
const HEAD: u64 = 16 << 10;

/// An answer to a request.
pub struct Response {
    /// The status code.
    pub status: u16,
    /// The value of `Content-Type`.
    pub mime: &'static str,
    /// The body; left out for `HEAD`.
    pub body: Vec<u8>,
}

impl Response {
    /// A page of plain text.
    pub fn text(status: u16, text: impl Into<String>) -> Self {
        Self { status, mime: "text/plain; charset=utf-8", body: text.into().into_bytes() }
    }
}

/// Listens on the loopback interface: on `port` itself, or without one on the first free port from 8080 on.
pub fn listen(port: Option<u16>) -> Result<TcpListener> {
    let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    match port {
        Some(port) => {
            bind(port).with_context(|| format!("could not listen on port {port}; another program may use it"))
        }
        None => (8080..8100).find_map(|port| bind(port).ok()).map_or_else(|| Ok(bind(0)?), Ok),
    }
}

/// Answers requests for ever. `answer` gets the decoded path and the query.
pub fn serve(listener: &TcpListener, answer: impl Fn(&str, &str) -> Response + Send + Sync + 'static) {
    let answer = Arc::new(answer);
    for stream in listener.incoming().flatten() {
        let answer = Arc::clone(&answer);
        std::thread::spawn(move || {
            // A browser that goes away in the middle of a file is no news.
            let _ = converse(&stream, &*answer);
        });
    }
}

fn converse(stream: &TcpStream, answer: &dyn Fn(&str, &str) -> Response) -> io::Result<()> {
    stream.set_read_timeout(Some(Duration::from_secs(60)))?;
    stream.set_nodelay(true)?;
    let mut reader = BufReader::new(stream);
    let mut writer = stream;
    loop {
        let Some(head) = read_head(&mut reader)? else { return Ok(()) };
        let (response, with_body) = match parse(&head) {
            Ok(Request { head_only, path, query }) => (answer(&path, &query), !head_only),
            Err(response) => (response, true),
        };
        let reason = match response.status {
            200 => "OK",
            404 => "Not Found",
            405 => "Method Not Allowed",
            500 => "Internal Server Error",
            _ => "Bad Request",
        };
        let length = response.body.len();
        let mut out = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {length}\r\nCache-Control: no-store\r\n\
             X-Content-Type-Options: nosniff\r\n\r\n",
            response.status, response.mime
        )
        .into_bytes();
        if with_body {
            out.extend_from_slice(&response.body);
        }
        writer.write_all(&out)?;
        // Only a request that was understood leaves the connection in a known state.
        if response.status == 400 || response.status == 405 {
            return Ok(());
        }
    }
}

/// The lines up to the blank one, or `None` at the end of the connection.
fn read_head(reader: &mut impl BufRead) -> io::Result<Option<Vec<String>>> {
    let mut limited = reader.take(HEAD);
    let mut lines = Vec::new();
    loop {
        let mut line = String::new();
        if limited.read_line(&mut line)? == 0 {
            return Ok(None);
        }
        let line = line.trim_end();
        if line.is_empty() {
            return Ok(Some(lines));
        }
        lines.push(line.to_owned());
    }
}

struct Request {
    head_only: bool,
    path: String,
    query: String,
}

fn parse(head: &[String]) -> Result<Request, Response> {
    let bad = || Response::text(400, "This is no request that this server understands.\n");
    let mut words = head.first().ok_or_else(bad)?.split(' ');
    let (method, target) = (words.next().ok_or_else(bad)?, words.next().ok_or_else(bad)?);
    if method != "GET" && method != "HEAD" {
        return Err(Response::text(405, "This server only hands out files.\n"));
    }
    let host = head.iter().skip(1).find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.eq_ignore_ascii_case("host").then(|| value.trim())
    });
    let name = host.map(|host| host.rsplit_once(':').map_or(host, |(name, _)| name));
    if !matches!(name, Some("localhost" | "127.0.0.1")) {
        return Err(Response::text(400, "This server answers to localhost alone.\n"));
    }
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let path = decode(path).filter(|path| is_plain(path)).ok_or_else(bad)?;
    Ok(Request { head_only: method == "HEAD", path, query: query.to_owned() })
}

/// Undoes `%20` and the like.
fn decode(path: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digits = [rest.next()?, rest.next()?];
            bytes.push(u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok()
}

/// Whether a decoded path stays inside the folder it is joined to, hidden files left out.
fn is_plain(path: &str) -> bool {
    path.starts_with('/')
        && !path.contains(['\\', '\0', ':'])
        && !path[1..].split('/').any(|part| part.starts_with('.'))
}

/// The content type that belongs to a file's name.
pub fn mime(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, extension)| extension) {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" | "gltf" | "webmanifest" => "application/json",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "glb" => "model/gltf-binary",
        "obj" => "model/obj",
        "mtl" | "txt" | "md" | "limn" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(target: &str, host: &str) -> Vec<String> {
        vec![format!("GET {target} HTTP/1.1"), format!("Host: {host}")]
    }

    #[test]
    fn a_path_is_decoded_and_never_leaves_its_folder() {
        let path = |target: &str| parse(&head(target, "localhost:8080")).ok().map(|request| request.path);
        assert_eq!(path("/a%20b/c.js?x=1").as_deref(), Some("/a b/c.js"));
        for escape in
            ["/../Cargo.toml", "/web/%2e%2e/x", "/.git/config", "/a/..%2fb", "/c:/x", "/a\\b", "x", "/%", "/%zz"]
        {
            assert_eq!(path(escape), None, "{escape}");
        }
    }

    #[test]
    fn other_host_names_and_methods_are_refused() {
        assert!(parse(&head("/", "127.0.0.1:1")).is_ok());
        assert!(parse(&head("/", "evil.example")).is_err());
        assert!(parse(&["POST / HTTP/1.1".to_owned(), "Host: localhost".to_owned()]).is_err());
        assert!(parse(&[]).is_err());
    }

    #[test]
    fn a_connection_serves_several_requests_and_head_has_no_body() {
        let listener = listen(Some(0)).unwrap();
        let address = listener.local_addr().unwrap();
        std::thread::spawn(move || serve(&listener, |path, query| Response::text(200, format!("{path}|{query}"))));
        let mut stream = TcpStream::connect(address).unwrap();
        let ask = |stream: &mut TcpStream, method: &str, until: &str| {
            write!(stream, "{method} /x?y HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
            let mut seen = Vec::new();
            while !String::from_utf8_lossy(&seen).ends_with(until) {
                let mut byte = [0];
                stream.read_exact(&mut byte).unwrap();
                seen.push(byte[0]);
            }
            String::from_utf8(seen).unwrap()
        };
        assert!(ask(&mut stream, "HEAD", "\r\n\r\n").contains("Content-Length: 4"));
        assert!(ask(&mut stream, "GET", "/x|y").starts_with("HTTP/1.1 200 OK"));
    }
}
