/*
 * An EtherCAT slave in C at the SPI of a virtual TMC8461: four bytes of outputs, four of inputs, no
 * mailbox. It gives the first two output bytes back, and a count of the output frames it has seen.
 *
 *   build/release/src/cli/stator run racks/tmc8461.toml --link ethercat:drive
 *   build/release/examples/example_io_slave unix:/tmp/stator-chip
 *
 * Everything but main() and the two functions below `spi` would be the same on a board with spidev.
 */
#define _POSIX_C_SOURCE 200809L

#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "stator_chip.h"

/* Registers of the slave controller (TMC8461 datasheet chapter 6). */
enum {
  AL_CONTROL = 0x0120,
  AL_STATUS = 0x0130,
  AL_STATUS_CODE = 0x0134,
  AL_EVENT_MASK = 0x0204,
  WATCHDOG_STATUS = 0x0440,
  SYNC_MANAGERS = 0x0800
};
enum { EVENT_AL_CONTROL = 0x01, EVENT_SYNC_MANAGERS = 0x10, EVENT_WATCHDOG = 0x40 };
#define EVENT_OUTPUTS 0x0400u /* sync manager 2 */
#define EVENTS ((uint32_t)(EVENT_AL_CONTROL | EVENT_SYNC_MANAGERS | EVENT_WATCHDOG) | EVENT_OUTPUTS)

/* What the EEPROM says, see racks/tmc8461.toml. */
enum { OUTPUTS = 0x1100, INPUTS = 0x1400, LENGTH = 4 };

enum { INIT = 1, PRE_OPERATIONAL = 2, SAFE_OPERATIONAL = 4, OPERATIONAL = 8, ERROR_FLAG = 0x10 };
enum {
  INVALID_CHANGE = 0x11,
  UNKNOWN_STATE = 0x12,
  INVALID_SYNC_MANAGERS = 0x17,
  OUTPUT_WATCHDOG = 0x1B
};

typedef struct {
  stator_chip *chip;
  uint32_t events; /* as the header of the last transfer showed them */
  unsigned state;
  unsigned failed;
  uint16_t frames;
} slave;

static volatile sig_atomic_t stopped;

static void stop(int number) {
  (void)number;
  stopped = 1;
}

/* One datagram: the only way to the chip. False: there is none any more. */
static int spi(slave *s, const uint8_t *tx, uint8_t *rx, size_t length) {
  if (stator_chip_spi_transfer(s->chip, STATOR_CHIP_PDI, tx, rx, length) < 0) {
    return 0;
  }
  s->events = rx[0] | (uint32_t)rx[1] << 8 | (uint32_t)rx[2] << 16;
  return 1;
}

enum { HEADER = 3, NOP = 0, READ_WITH_WAIT_STATE = 3, WRITE = 4, LONGEST = 64 };

static void put_header(uint8_t *tx, unsigned address, unsigned command) {
  tx[0] = (uint8_t)(address >> 5);
  tx[1] = (uint8_t)((address & 0x1Fu) << 3 | 6u);
  tx[2] = (uint8_t)((address >> 13) << 5 | command << 2);
}

static int esc_read(slave *s, unsigned address, void *data, size_t length) {
  uint8_t tx[HEADER + 1 + LONGEST] = {0};
  uint8_t rx[sizeof tx];
  put_header(tx, address, READ_WITH_WAIT_STATE);
  tx[HEADER] = 0xFF;
  tx[HEADER + length] = 0xFF; /* ends the read */
  const int done = spi(s, tx, rx, HEADER + 1 + length);
  memcpy(data, rx + HEADER + 1, length);
  return done;
}

static int esc_write(slave *s, unsigned address, const void *data, size_t length) {
  uint8_t tx[HEADER + LONGEST];
  uint8_t rx[sizeof tx];
  put_header(tx, address, WRITE);
  memcpy(tx + HEADER, data, length);
  return spi(s, tx, rx, HEADER + length);
}

static unsigned esc_read16(slave *s, unsigned address) {
  uint8_t bytes[2] = {0, 0};
  esc_read(s, address, bytes, sizeof bytes);
  return bytes[0] | (unsigned)bytes[1] << 8;
}

static void esc_write16(slave *s, unsigned address, unsigned value) {
  const uint8_t bytes[2] = {(uint8_t)value, (uint8_t)(value >> 8)};
  esc_write(s, address, bytes, sizeof bytes);
}

static void show(slave *s, unsigned state, unsigned code) {
  s->state = state;
  s->failed = code != 0;
  esc_write16(s, AL_STATUS_CODE, code);
  esc_write16(s, AL_STATUS, state | (code != 0 ? ERROR_FLAG : 0u));
  printf("state %u, code %04Xh\n", state, code);
  fflush(stdout);
}

/* The master has set up sync managers 2 and 3 as the EEPROM says. */
static int process_data_configured(slave *s) {
  uint8_t sm[16] = {0};
  esc_read(s, SYNC_MANAGERS + 16, sm, sizeof sm);
  return (sm[0] | sm[1] << 8) == OUTPUTS && (sm[2] | sm[3] << 8) == LENGTH && (sm[6] & 1) != 0 &&
         (sm[8] | sm[9] << 8) == INPUTS && (sm[10] | sm[11] << 8) == LENGTH && (sm[14] & 1) != 0;
}

/* Sync managers 2 and 3 answer the master, or not: then its working counter tells it what buffers
 * with old content would hide. */
static void open_process_data(slave *s, int open) {
  const uint8_t deactivate = open ? 0 : 1;
  esc_write(s, SYNC_MANAGERS + 8 * 2 + 7, &deactivate, 1);
  esc_write(s, SYNC_MANAGERS + 8 * 3 + 7, &deactivate, 1);
}

static void write_inputs(slave *s, const uint8_t *outputs) {
  const uint8_t inputs[LENGTH] = {outputs[0], outputs[1], (uint8_t)s->frames,
                                  (uint8_t)(s->frames >> 8)};
  esc_write(s, INPUTS, inputs, sizeof inputs);
}

/* A request of the master (ETG.1000.6): one step up, or down to any state below. */
static void answer_state_request(slave *s) {
  static const uint8_t nothing[LENGTH] = {0};
  const unsigned control = esc_read16(s, AL_CONTROL); /* acknowledges the event */
  const unsigned target = control & 0x0Fu;
  if (s->failed && (control & ERROR_FLAG) == 0 && target > s->state) {
    return;
  }
  if (target != INIT && target != PRE_OPERATIONAL && target != SAFE_OPERATIONAL &&
      target != OPERATIONAL) {
    show(s, s->state, UNKNOWN_STATE);
  } else if (target > 2 * s->state) {
    show(s, s->state, INVALID_CHANGE);
  } else if (target == SAFE_OPERATIONAL && s->state == PRE_OPERATIONAL &&
             !process_data_configured(s)) {
    show(s, s->state, INVALID_SYNC_MANAGERS);
  } else {
    if (target < SAFE_OPERATIONAL) {
      open_process_data(s, 0);
    } else if (s->state == PRE_OPERATIONAL) {
      open_process_data(s, 1);
    }
    if (target == SAFE_OPERATIONAL) {
      s->frames = 0;
      write_inputs(s, nothing);
    }
    show(s, target, 0);
  }
}

static void take_outputs(slave *s) {
  uint8_t outputs[LENGTH] = {0};
  esc_read(s, OUTPUTS, outputs, sizeof outputs);
  if (s->state == OPERATIONAL) {
    ++s->frames;
    write_inputs(s, outputs);
  }
}

/* A program before this one may have left the chip Operational, and the master believes that. */
static void start(slave *s) {
  const uint8_t mask[4] = {EVENTS & 0xFF, EVENTS >> 8 & 0xFF, 0, 0};
  esc_write(s, AL_EVENT_MASK, mask, sizeof mask);
  open_process_data(s, 0);
  show(s, INIT, 0);
}

static void look_at_sync_managers(slave *s) {
  uint8_t activate;
  for (unsigned i = 0; i < 8; ++i) {
    esc_read(s, SYNC_MANAGERS + 8 * i + 6, &activate, 1); /* acknowledges */
  }
}

/* Until no event is left; each access brings the next look at them. */
static int handle_events(slave *s) {
  const uint8_t nop[HEADER] = {0, 6, NOP};
  uint8_t rx[HEADER];
  while (spi(s, nop, rx, sizeof nop)) {
    const uint32_t events = s->events & EVENTS;
    if (events == 0) {
      return 1;
    }
    if ((events & EVENT_AL_CONTROL) != 0) {
      answer_state_request(s);
    }
    if ((events & EVENT_SYNC_MANAGERS) != 0) {
      look_at_sync_managers(s);
    }
    if ((events & EVENT_OUTPUTS) != 0) {
      take_outputs(s);
    }
    if ((events & EVENT_WATCHDOG) != 0 && (esc_read16(s, WATCHDOG_STATUS) & 1u) == 0 &&
        s->state == OPERATIONAL) {
      show(s, SAFE_OPERATIONAL, OUTPUT_WATCHDOG);
    }
  }
  return 0;
}

int main(int count, char **arguments) {
  char error[320];
  slave s = {0};
  if (count != 2) {
    fprintf(stderr, "usage: %s unix:PATH or tcp:HOST:PORT\n", arguments[0]);
    return 2;
  }
  signal(SIGINT, stop);
  signal(SIGTERM, stop);
  s.chip = stator_chip_open(arguments[1], error, sizeof error);
  if (s.chip == NULL) {
    fprintf(stderr, "%s\n", error);
    return 1;
  }
  stator_chip_watch(s.chip, STATOR_LINE_IRQ | STATOR_LINE_RESET_OUT | STATOR_LINE_POWER);
  start(&s);
  while (!stopped && handle_events(&s)) {
    stator_chip_event event;
    /* Now and then an access, for the PDI watchdog. */
    const int came = stator_chip_wait_event(s.chip, &event, 50);
    if (came < 0) {
      break;
    }
    if (came != 0 && ((event.rose | event.fell) & (STATOR_LINE_RESET_OUT | STATOR_LINE_POWER))) {
      start(&s); /* the chip has forgotten everything */
    }
  }
  fprintf(stderr, "%s\n", stopped ? "stopped" : stator_chip_error(s.chip));
  stator_chip_close(s.chip);
  return stopped ? 0 : 1;
}
