//! zencan-client, unmodified, as the master of a TMCC160.
//!
//!     zencan_drive INTERFACE
//!
//! Tells what it sees in lines that start with a word; ../../masters.py says which it has to see. After "turned"
//! it waits until somebody disturbs the bus, tells how it noticed, and begins anew when the drive boots.

use std::time::{Duration, Instant};
use zencan_client::common::traits::AsyncCanSender;
use zencan_client::{open_socketcan, BusManager, SdoClientError};

const NODE: u8 = 5;
const PATIENCE: Duration = Duration::from_secs(60);
const SHORT: Duration = Duration::from_secs(2);

#[tokio::main]
async fn main() {
    let interface = std::env::args().nth(1).expect("the name of an interface");
    let (sender, receiver) = open_socketcan(&interface).expect("a CAN socket");
    let mut bus = BusManager::new(sender, receiver);

    wait_for_answer(&bus).await;
    match bus.scan_nodes().await {
        Ok(nodes) => {
            for node in nodes {
                let name = node.device_name.unwrap_or_default();
                println!("node {} {name}", node.node_id);
            }
        }
        Err(error) => println!("no scan: {error}"),
    }
    session(&mut bus).await.expect("a session");
    println!("lost {}", wait_for_loss(&bus).await);
    wait_for_answer(&bus).await;
    session(&mut bus)
        .await
        .expect("a session after it was found again");
    println!("found");
}

macro_rules! sdo {
    ($bus:expr, $call:ident ( $($argument:expr),* )) => {{
        let mut client = $bus.sdo_client(NODE);
        client.set_timeout(PATIENCE);
        client.$call($($argument),*).await
    }};
}

/// Refusals, and an axis that turns in profile velocity mode.
async fn session<S: AsyncCanSender + Send + Sync>(
    bus: &mut BusManager<S>,
) -> Result<(), SdoClientError> {
    println!("name {}", sdo!(bus, read_device_name())?);
    match sdo!(bus, read_identity()) {
        Ok(identity) => println!("identity {:08X}", identity.vendor_id),
        Err(error) => println!("no identity: {error}"),
    }
    tell(sdo!(bus, write_u16(0x6041, 0, 0)).err());
    tell(sdo!(bus, read_u16(0x5FFF, 0)).err());
    tell(sdo!(bus, read_u32(0x1018, 9)).err());
    tell(sdo!(bus, write_i8(0x6060, 0, 7)).err());
    bus.nmt_start(NODE).await;
    sdo!(bus, write_i8(0x6060, 0, 3))?;
    sdo!(bus, write_u32(0x2020, 3, 20_000))?;
    sdo!(bus, write_u32(0x6083, 0, 10_000))?;
    sdo!(bus, write_u32(0x6084, 0, 10_000))?;
    for (controlword, expected) in [(6, 0x21), (7, 0x23), (15, 0x27)] {
        sdo!(bus, write_u16(0x6040, 0, controlword))?;
        let start = Instant::now();
        while sdo!(bus, read_u16(0x6041, 0))? & 0x6F != expected {
            assert!(start.elapsed() < PATIENCE, "no state {expected:02X}h");
        }
    }
    for speed in [1200, 0] {
        sdo!(bus, write_i32(0x60FF, 0, speed))?;
        let start = Instant::now();
        while (sdo!(bus, read_i32(0x606C, 0))? - speed).abs() > 30 {
            assert!(start.elapsed() < PATIENCE, "no {speed} rpm");
        }
        println!("turned {speed}");
    }
    let known = bus.node_list().await;
    let node = known
        .iter()
        .find(|node| node.node_id == NODE)
        .expect("a known node");
    println!("state {:?}", node.nmt_state);
    Ok(())
}

fn tell(refusal: Option<SdoClientError>) {
    match refusal {
        Some(error) => println!("refused {error}"),
        None => println!("refused not"),
    }
}

async fn wait_for_loss<S: AsyncCanSender + Send + Sync>(bus: &BusManager<S>) -> SdoClientError {
    loop {
        let mut client = bus.sdo_client(NODE);
        client.set_timeout(SHORT);
        if let Err(error) = client.read_u32(0x1000, 0).await {
            return error;
        }
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

async fn wait_for_answer<S: AsyncCanSender + Send + Sync>(bus: &BusManager<S>) {
    let start = Instant::now();
    loop {
        let mut client = bus.sdo_client(NODE);
        client.set_timeout(SHORT);
        if client.read_u32(0x1000, 0).await.is_ok() {
            return;
        }
        assert!(start.elapsed() < 4 * PATIENCE, "not found again");
    }
}
