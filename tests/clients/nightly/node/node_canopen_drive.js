// node-canopen (package "canopen"), unmodified, as the master of a TMCC160 behind slcan over TCP.
//
//     node_canopen_drive.js PORT
//
// Tells what it sees in lines that start with a word; ../../masters.py says which it has to see. After "turned"
// it waits until the heartbeat stays away, and begins anew when it is back.

const net = require('net');
const { createRequire } = require('module');
const path = require('path');
const process = require('process');

const packages = process.env.STATOR_NODE_PACKAGES;
const { Device, DataType } = createRequire(path.join(packages, 'package.json'))('canopen');

const NODE = 5;
const PATIENCE = 60000; // ms
const SHORT = 2000;

/** An slcan adapter: what the library says and hears, as lines. */
class Adapter {
    constructor(port, heard) {
        this.socket = net.connect(port, '127.0.0.1');
        this.socket.setNoDelay(true);
        this.socket.write('C\rO\r');
        let rest = '';
        this.socket.on('data', (data) => {
            const lines = (rest + data.toString('latin1')).split('\r');
            rest = lines.pop();
            for (const line of lines) {
                const frame = /^\x07*t(...)(.)(.*)$/.exec(line);
                if (frame)
                    heard({ id: parseInt(frame[1], 16), data: Buffer.from(frame[3], 'hex') });
            }
        });
    }

    send({ id, data }) {
        const hex = data.toString('hex').toUpperCase();
        this.socket.write(`t${id.toString(16).toUpperCase().padStart(3, '0')}${data.length}${hex}\r`);
    }

    close() {
        this.socket.end();
    }
}

function tell(...words) {
    console.log(words.join(' '));
}

function read(device, index, subIndex, dataType, timeout = PATIENCE) {
    return device.sdo.upload({ deviceId: NODE, index, subIndex, dataType, timeout });
}

function write(device, index, subIndex, data, dataType) {
    return device.sdo.download({ deviceId: NODE, index, subIndex, data, dataType, timeout: PATIENCE });
}

async function refused(action) {
    try {
        await action;
        tell('refused', 'not');
    } catch (error) {
        tell('refused', error.code.toString(16).padStart(8, '0'), error.message);
    }
}

async function until(condition, what) {
    const end = Date.now() + PATIENCE;
    while (!await condition()) {
        if (Date.now() > end)
            throw new Error(`${what}: not in time`);
    }
}

async function session(device) {
    tell('name', await read(device, 0x1008, 0, DataType.VISIBLE_STRING));
    await refused(write(device, 0x6041, 0, 0, DataType.UNSIGNED16));
    await refused(read(device, 0x5FFF, 0, DataType.UNSIGNED16));
    await refused(read(device, 0x1018, 9, DataType.UNSIGNED32));
    await refused(write(device, 0x6060, 0, 7, DataType.INTEGER8));
    device.nmt.startNode(NODE);
    await write(device, 0x6060, 0, 3, DataType.INTEGER8);
    await write(device, 0x2020, 3, 20000, DataType.UNSIGNED32);
    await write(device, 0x6083, 0, 10000, DataType.UNSIGNED32);
    await write(device, 0x6084, 0, 10000, DataType.UNSIGNED32);
    for (const [controlword, expected] of [[6, 0x21], [7, 0x23], [15, 0x27]]) {
        await write(device, 0x6040, 0, controlword, DataType.UNSIGNED16);
        await until(async () => (await read(device, 0x6041, 0, DataType.UNSIGNED16) & 0x6F) === expected,
            `state ${expected.toString(16)}h`);
    }
    for (const speed of [1200, 0]) {
        await write(device, 0x60FF, 0, speed, DataType.INTEGER32);
        await until(async () => Math.abs(await read(device, 0x606C, 0, DataType.INTEGER32) - speed) < 30,
            `${speed} rpm`);
        tell('turned', speed);
    }
}

function once(emitter, name) {
    return new Promise((resolve) => emitter.once(name, (...rest) => resolve(rest)));
}

async function main() {
    const device = new Device({ id: 1 });
    device.eds.addSdoClientParameter(NODE, 0x600 + NODE, 0x580 + NODE);
    device.eds.addHeartbeatConsumer(NODE, 5000);
    device.eds.addEmcyConsumer(0x80 + NODE);
    device.emcy.addListener('emergency', ({ em }) => tell('emergency', String(em)));
    const adapter = new Adapter(Number(process.argv[2]), (message) => device.receive(message));
    device.addListener('message', (message) => adapter.send(message));
    const heard = once(device.nmt, 'heartbeat');
    device.start();
    await heard;
    await session(device);

    const lost = once(device.nmt, 'timeout');
    tell('ready');
    const [node] = await lost;
    const back = once(device.nmt, 'heartbeat');
    tell('lost heartbeat of', node);
    await refused(read(device, 0x1000, 0, DataType.UNSIGNED32, SHORT));
    await back;
    await session(device);
    tell('found');
    device.stop();
    adapter.close();
}

main().catch((error) => {
    console.error(error);
    process.exit(1);
});
