//! The wire: a serial line (or a pseudo-terminal, which opens like one) or a telnet socket.

use super::emulated::Emulated;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a read waits for a first byte. Commands wait as long at most.
const READ_WAIT: Duration = Duration::from_millis(5);

/// How long a write may take before the port is taken for dead: 128 bytes take 11 ms at 115,200 baud.
const WRITE_WAIT: Duration = Duration::from_secs(1);

/// How long a board on the network may take to be reached.
const CONNECT_WAIT: Duration = Duration::from_secs(5);

/// The fastest clock of an emulated board: a day's job in half a minute.
const MAX_SPEED: u32 = 3000;

/// Where telnet listens (FluidNC, grblHAL).
const TELNET: u16 = 23;

/// Bytes to and from a board, blocking for a few milliseconds at most.
#[cfg_attr(test, mockall::automock)]
pub trait Port: Send {
    /// Bytes that have come, 0 when none came in time.
    ///
    /// # Errors
    /// The port is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Writes all bytes.
    ///
    /// # Errors
    /// The port is gone or takes nothing.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// Where a board hangs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// A device: `/dev/ttyUSB0`, `/dev/serial/by-id/...`, `COM3`, a pseudo-terminal.
    Device(PathBuf),
    /// A host and port on the network.
    Network(String, u16),
    /// A board in the computer, whose clock runs so many times as fast as ours.
    Emulator(u32),
}

/// A port that cannot be opened.
#[derive(Debug, thiserror::Error)]
#[error("{address} cannot be opened: {reason}")]
pub struct OpenError {
    address: Address,
    reason: String,
}

/// A device that may have a board on it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Listed {
    /// Its path or name; may change when it is plugged in again.
    pub path: String,
    /// A path that stays the same, where the system keeps one.
    pub stable: Option<String>,
    /// Maker and product as it says itself; empty when it does not.
    pub what: String,
}

impl Address {
    /// Reads what users type: `emulator`, `emulator:50x` (at 50 times the speed), `tcp:HOST`, `tcp:HOST:PORT`, or the path of a device.
    pub fn parse(text: &str) -> Address {
        let times = |rest: &str| rest.strip_prefix(':')?.strip_suffix('x')?.parse().ok();
        let speed = text.strip_prefix("emulator").and_then(|rest| if rest.is_empty() { Some(1) } else { times(rest) });
        if let Some(speed) = speed.filter(|speed| (1..=MAX_SPEED).contains(speed)) {
            return Address::Emulator(speed);
        }
        let Some(host) = text.strip_prefix("tcp:") else { return Address::Device(text.into()) };
        let host = host.trim_start_matches('/');
        match host.rsplit_once(':').map(|(host, port)| (host, port.parse())) {
            Some((host, Ok(port))) => Address::Network(host.to_owned(), port),
            _ => Address::Network(host.to_owned(), TELNET),
        }
    }

    /// Opens it; a serial line at `baud` bits a second. Most boards on a serial line are reset by it.
    ///
    /// # Errors
    /// What the system says, with the way out where one is known.
    pub fn open(&self, baud: u32) -> Result<Box<dyn Port>, OpenError> {
        let fail = |reason: String| OpenError { address: self.clone(), reason };
        match self {
            Address::Device(path) => {
                let opened = serialport::new(path.to_string_lossy(), baud).timeout(READ_WAIT).open();
                Ok(Box::new(Serial(opened.map_err(|e| fail(device_reason(&e)))?)))
            }
            Address::Emulator(speed) => Ok(Box::new(Emulated::new(READ_WAIT, *speed))),
            Address::Network(host, port) => {
                let found = (host.as_str(), *port).to_socket_addrs().map_err(|e| fail(e.to_string()))?;
                let mut reason = "no such host".to_owned();
                for address in found {
                    match TcpStream::connect_timeout(&address, CONNECT_WAIT).and_then(prepare) {
                        Ok(stream) => return Ok(Box::new(Network(stream))),
                        Err(e) => reason = e.to_string(),
                    }
                }
                Err(fail(reason))
            }
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Address::Device(path) => write!(f, "{}", path.display()),
            Address::Emulator(_) => write!(f, "the emulator"),
            Address::Network(host, port) => write!(f, "tcp:{host}:{port}"),
        }
    }
}

fn device_reason(error: &serialport::Error) -> String {
    match error.kind() {
        serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => {
            format!("{error}; on Linux join the group that owns it: sudo usermod -aG dialout $USER, then log in again")
        }
        serialport::ErrorKind::NoDevice => format!("{error}; it is unplugged, or another program holds it"),
        _ => error.to_string(),
    }
}

fn prepare(stream: TcpStream) -> io::Result<TcpStream> {
    stream.set_read_timeout(Some(READ_WAIT))?;
    stream.set_write_timeout(Some(WRITE_WAIT))?;
    stream.set_nodelay(true)?;
    Ok(stream)
}

/// Nothing in time is no error.
fn patient(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Err(e) if matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(0),
        read => read,
    }
}

struct Serial(Box<dyn serialport::SerialPort>);

impl Port for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        patient(self.0.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        // The one timeout of a serial port holds for both ways.
        self.0.set_timeout(WRITE_WAIT)?;
        let written = self.0.write_all(bytes);
        self.0.set_timeout(READ_WAIT)?;
        written
    }
}

struct Network(TcpStream);

impl Port for Network {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer) {
            Ok(0) => Err(io::Error::new(ErrorKind::UnexpectedEof, "the board closed the connection")),
            read => patient(read),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.write_all(bytes)
    }
}

/// Devices that may have a board on them. None is opened: opening resets most boards.
///
/// # Errors
/// The system does not tell.
pub fn list_ports() -> io::Result<Vec<Listed>> {
    let found = serialport::available_ports().map_err(io::Error::from)?;
    let what = |kind: &serialport::SerialPortType| match kind {
        serialport::SerialPortType::UsbPort(usb) => {
            let words = [usb.manufacturer.as_deref(), usb.product.as_deref()];
            words.into_iter().flatten().collect::<Vec<_>>().join(" ")
        }
        _ => String::new(),
    };
    let listed = found.into_iter().map(|port| Listed {
        what: what(&port.port_type),
        stable: stable_path(Path::new("/dev/serial/by-id"), Path::new(&port.port_name)),
        path: port.port_name,
    });
    Ok(listed.collect())
}

/// The link in `folder` that leads to `device`.
fn stable_path(folder: &Path, device: &Path) -> Option<String> {
    let device = device.canonicalize().ok()?;
    let mut links: Vec<PathBuf> = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    links.sort();
    let link = links.into_iter().find(|link| link.canonicalize().is_ok_and(|target| target == device))?;
    Some(link.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_devices_or_hosts() {
        assert_eq!(Address::parse("/dev/ttyUSB0"), Address::Device("/dev/ttyUSB0".into()));
        assert_eq!(Address::parse("tcp:fluidnc.local"), Address::Network("fluidnc.local".into(), 23));
        assert_eq!(Address::parse("tcp://10.0.0.7:8080"), Address::Network("10.0.0.7".into(), 8080));
        assert_eq!(Address::parse("tcp:h:1").to_string(), "tcp:h:1");
        assert_eq!(["emulator", "emulator:50x"].map(Address::parse), [Address::Emulator(1), Address::Emulator(50)]);
        for text in ["emulator:0x", "emulator:9999x", "emulator:fast", "emulators"] {
            assert_eq!(Address::parse(text), Address::Device(text.into()));
        }
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        let error = Address::parse("/dev/no-such-port").open(115_200).err().unwrap().to_string();
        assert!(error.starts_with("/dev/no-such-port cannot be opened"), "{error}");
    }

    #[test]
    fn a_socket_carries_bytes_waits_in_vain_and_notices_its_end() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let address = Address::Network("127.0.0.1".into(), listener.local_addr().unwrap().port());
        let mut port = address.open(0).unwrap();
        let (mut board, _) = listener.accept().unwrap();
        let mut buffer = [0; 16];
        assert_eq!(port.read(&mut buffer).unwrap(), 0);
        port.write(b"?\n").unwrap();
        board.read_exact(&mut buffer[..2]).unwrap();
        assert_eq!(&buffer[..2], b"?\n");
        board.write_all(b"ok").unwrap();
        let count = (0..200).map(|_| port.read(&mut buffer).unwrap()).find(|n| *n > 0);
        assert_eq!(count, Some(2));
        drop(board);
        assert!((0..200).any(|_| port.read(&mut buffer).is_err()));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_that_leads_to_the_device_is_its_stable_name() {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("tty0");
        std::fs::write(&device, "").unwrap();
        let links = folder.path().join("by-id");
        std::fs::create_dir(&links).unwrap();
        std::os::unix::fs::symlink(&device, links.join("usb-laser")).unwrap();
        assert!(stable_path(&links, &device).unwrap().ends_with("usb-laser"));
        assert_eq!(stable_path(&links, &folder.path().join("tty1")), None);
    }
}
