//! ethercrab, unmodified, as the master of a TMCM-3315, a TMC8670 and a TMC8461 on one segment.
//!
//!     ethercrab_segment INTERFACE
//!
//! Tells what it sees in lines that start with a word; ../../masters.py says which it has to see. After "turned"
//! it waits until somebody disturbs the segment, tells how it noticed, and begins anew until all is as before.

use ethercrab::{
    error::Error, std::ethercat_now, std::tx_rx_task, subdevice_group::Op, MainDevice,
    MainDeviceConfig, PduStorage, RetryBehaviour, SubDeviceGroup, SubDeviceState, Timeouts,
};
use std::time::{Duration, Instant};

const MAX_DEVICES: usize = 4;
const PROCESS_DATA: usize = 512;
const PATIENCE: Duration = Duration::from_secs(60);
const TURNS: i32 = 2 * 51_200;
const STATUSWORD_MASK: u16 = 0x6F;

static STORAGE: PduStorage<16, { PduStorage::element_size(1100) }> = PduStorage::new();

type Group = SubDeviceGroup<MAX_DEVICES, PROCESS_DATA, ethercrab::DefaultLock, Op>;

fn main() {
    let interface = std::env::args().nth(1).expect("the name of an interface");
    let (tx, rx, pdu_loop) = STORAGE.try_split().expect("the only one");
    let timeouts = Timeouts {
        state_transition: PATIENCE,
        pdu: Duration::from_millis(200),
        eeprom: Duration::from_secs(5),
        wait_loop_delay: Duration::from_millis(1),
        mailbox_echo: Duration::from_secs(5),
        mailbox_response: Duration::from_secs(10),
    };
    let config = MainDeviceConfig {
        dc_static_sync_iterations: 100,
        retry_behaviour: RetryBehaviour::Count(2),
    };
    let main_device = MainDevice::new(pdu_loop, timeouts, config);
    let task = tx_rx_task(&interface, tx, rx).expect("a raw socket");
    smol::block_on(async {
        smol::spawn(async move { task.await.map(|_| ()) }).detach();
        let group = session(&main_device).await.expect("a session");
        println!("lost {}", wait_for_loss(&group, &main_device).await);
        drop(group);
        let start = Instant::now();
        loop {
            match session(&main_device).await {
                Ok(_) => break,
                Err(error) => assert!(start.elapsed() < 4 * PATIENCE, "not found again: {error}"),
            }
            smol::Timer::after(Duration::from_millis(100)).await;
        }
        println!("found");
    });
}

/// From nothing to an axis that has turned.
async fn session(main_device: &MainDevice<'static>) -> Result<Group, Error> {
    let group = main_device
        .init_single_group::<MAX_DEVICES, PROCESS_DATA>(ethercat_now)
        .await?;
    if group.len() != 3 {
        return Err(Error::Topology);
    }
    for device in group.iter(main_device) {
        println!("device {}", device.name());
        device.register_write(0x0420u16, 50_000u16).await?; // watchdog: 5 s
    }
    for index in 0..2 {
        refusals(&group.subdevice(main_device, index)?).await;
    }
    let gantry = group.subdevice(main_device, 0)?;
    gantry.sdo_write(0x2005, 0, 3u32).await?;
    gantry.sdo_write(0x6081, 0, 400_000u32).await?;
    gantry.sdo_write(0x6083, 0, 2_000_000u32).await?;
    gantry.sdo_write(0x6084, 0, 2_000_000u32).await?;
    gantry.sdo_write(0x6060, 0, 1i8).await?;
    drop(gantry);

    let group = group.into_safe_op(main_device).await?;
    group.tx_rx(main_device).await?;
    let group = group.request_into_op(main_device).await?;
    cycle_until(&group, main_device, |state, _| state == SubDeviceState::Op).await?;
    println!("operational");
    turn(&group, main_device).await?;
    Ok(group)
}

async fn refusals<S>(device: &ethercrab::SubDeviceRef<'_, S>)
where
    S: std::ops::Deref<Target = ethercrab::SubDevice>,
{
    tell(device.sdo_write(0x6041, 0, 0u16).await.err());
    tell(device.sdo_read::<u16>(0x5FFF, 0).await.err());
    tell(device.sdo_read::<u32>(0x1018, 9).await.err());
    tell(device.sdo_write(0x6060, 0, 99i8).await.err());
}

fn tell(refusal: Option<Error>) {
    match refusal {
        Some(error) => println!("refused {error}"),
        None => println!("refused not"),
    }
}

/// Exchanges process data until the first device's state and statusword are as wanted.
async fn cycle_until(
    group: &Group,
    main_device: &MainDevice<'static>,
    wanted: impl Fn(SubDeviceState, u16) -> bool,
) -> Result<(), Error> {
    let start = Instant::now();
    loop {
        let answer = group.tx_rx(main_device).await?;
        let state = answer
            .group_in_single_state()
            .unwrap_or(SubDeviceState::None);
        let status = {
            let gantry = group.subdevice(main_device, 0)?;
            let inputs = gantry.inputs_raw();
            u16::from_le_bytes([inputs[0], inputs[1]])
        };
        if wanted(state, status) {
            return Ok(());
        }
        assert!(
            start.elapsed() < PATIENCE,
            "state {state}, statusword {status:04X}h"
        );
        smol::Timer::after(Duration::from_millis(2)).await;
    }
}

fn write(
    group: &Group,
    main_device: &MainDevice<'static>,
    controlword: u16,
    target: i32,
) -> Result<(), Error> {
    let gantry = group.subdevice(main_device, 0)?;
    let mut outputs = gantry.outputs_raw_mut();
    outputs[0..2].copy_from_slice(&controlword.to_le_bytes());
    outputs[2..6].copy_from_slice(&target.to_le_bytes());
    Ok(())
}

fn position(group: &Group, main_device: &MainDevice<'static>) -> Result<i32, Error> {
    let gantry = group.subdevice(main_device, 0)?;
    let inputs = gantry.inputs_raw();
    Ok(i32::from_le_bytes([
        inputs[2], inputs[3], inputs[4], inputs[5],
    ]))
}

/// Two turns of the first axis in profile position mode.
async fn turn(group: &Group, main_device: &MainDevice<'static>) -> Result<(), Error> {
    for (controlword, expected) in [(6, 0x21), (7, 0x23), (15, 0x27)] {
        write(group, main_device, controlword, 0)?;
        cycle_until(group, main_device, |_, status| {
            status & STATUSWORD_MASK == expected
        })
        .await?;
    }
    let target = position(group, main_device)? + TURNS;
    write(group, main_device, 0x1F, target)?;
    cycle_until(group, main_device, |_, status| status & 0x1000 != 0).await?;
    write(group, main_device, 0x0F, target)?;
    cycle_until(group, main_device, |_, status| status & 0x1400 == 0x0400).await?;
    println!("turned {}", position(group, main_device)? - target + TURNS);
    Ok(())
}

async fn wait_for_loss(group: &Group, main_device: &MainDevice<'static>) -> String {
    let complete = group
        .tx_rx(main_device)
        .await
        .expect("process data")
        .working_counter;
    loop {
        match group.tx_rx(main_device).await {
            Ok(answer) if answer.working_counter != complete => {
                return format!("working counter {} of {complete}", answer.working_counter)
            }
            Ok(_) => (),
            Err(error) => return error.to_string(),
        }
        smol::Timer::after(Duration::from_millis(2)).await;
    }
}
