/*
 * Firmware on a PC at the pins of a virtual chip: the client of Stator's socket for chips
 * (docs/how-to/firmware-on-a-socket.md). C99 and POSIX sockets, nothing else. Apache-2.0.
 *
 * One object, one connection, one thread at a time. Calls that can fail return a number below 0 and
 * stator_chip_error() says why in a sentence; after STATOR_CHIP_CLOSED only stator_chip_close() is
 * of use.
 */
#ifndef STATOR_CHIP_H
#define STATOR_CHIP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct stator_chip stator_chip;

/* SPI slaves of the chip. */
#define STATOR_CHIP_PDI 0 /* the EtherCAT slave controller */
#define STATOR_CHIP_MFC 1 /* the multi-function I/O block, MFC CTRL */

/* Lines from the chip, as bits of levels and changes; 1 is the state the name says. */
#define STATOR_LINE_IRQ 0x0001u         /* PDI_SPI_IRQ */
#define STATOR_LINE_SYNC0 0x0002u       /* SYNC_OUT0 */
#define STATOR_LINE_SYNC1 0x0004u       /* SYNC_OUT1 */
#define STATOR_LINE_RESET_OUT 0x0008u   /* RESET_OUT */
#define STATOR_LINE_PROM_INIT 0x0010u   /* EEPROM loaded */
#define STATOR_LINE_LED_RUN 0x0020u     /* lit */
#define STATOR_LINE_LED_ERR 0x0040u     /* lit */
#define STATOR_LINE_LINK_ACT0 0x0080u   /* lit */
#define STATOR_LINE_LINK_ACT1 0x0100u   /* lit */
#define STATOR_LINE_WDSTATE 0x0200u     /* process data watchdog not expired */
#define STATOR_LINE_WDTRIGGER 0x0400u   /* pulse: that watchdog was restarted */
#define STATOR_LINE_SOF 0x0800u         /* pulse: start of a frame */
#define STATOR_LINE_EOF 0x1000u         /* pulse: end of a frame */
#define STATOR_LINE_MFC_IRQ 0x2000u     /* MFC_IRQ */
#define STATOR_LINE_POWER 0x4000u       /* supply */

/* Pins of the chip that its host drives. */
#define STATOR_PIN_LATCH0 0
#define STATOR_PIN_LATCH1 1
#define STATOR_PIN_NES 2
#define STATOR_PIN_NRESET 3

/* What calls return when they fail. */
#define STATOR_CHIP_REFUSED (-1) /* the chip's side says no; the connection goes on */
#define STATOR_CHIP_CLOSED (-2)  /* there is no connection any more */
#define STATOR_CHIP_MISUSE (-3)  /* an argument makes no sense */

/* Bytes of one transfer. */
#define STATOR_CHIP_MAXIMUM_TRANSFER 4096u

/* Lines that changed at one moment. One that rose and fell again is in both masks. */
typedef struct {
  uint16_t levels; /* of all lines, afterwards */
  uint16_t rose;
  uint16_t fell;
  uint16_t lost;    /* events before this one that were dropped because nobody read */
  uint64_t time_ns; /* of the simulation */
} stator_chip_event;

/* Connects to "unix:PATH" or "tcp:HOST:PORT" and introduces the program. Null if that fails; then,
 * if `error` is not null, a sentence of at most `size` characters with its end is there. */
stator_chip *stator_chip_open(const char *address, char *error, size_t size);
void stator_chip_close(stator_chip *chip);

/* Why the last call failed; empty if none did. */
const char *stator_chip_error(const stator_chip *chip);
/* The device's name in the rack. */
const char *stator_chip_name(const stator_chip *chip);
/* A descriptor that can be read when something has come, for poll(). */
int stator_chip_descriptor(const stator_chip *chip);

/* One datagram with chip select from its first to its last byte, as an SPI_IOC_MESSAGE with one
 * transfer is. `tx` may be null for zeros, `rx` for no interest. Returns `length`, at most
 * STATOR_CHIP_MAXIMUM_TRANSFER. */
int stator_chip_spi_transfer(stator_chip *chip, unsigned port, const void *tx, void *rx,
                             size_t length);
/* The same, with chip select lasting beyond the bytes if `keep_selected`, for a datagram in
 * pieces. */
int stator_chip_spi_piece(stator_chip *chip, unsigned port, const void *tx, void *rx, size_t length,
                          int keep_selected);
/* What the firmware's SPI leaves between the header of a read and its data, ns; a value below 0
 * (as at the start): long enough. A shorter pause than 240 ns is an error of the firmware, which
 * the chip counts. */
void stator_chip_set_read_pause(stator_chip *chip, long nanoseconds);

/* Which lines tell of their changes (STATOR_LINE_...). At the start: none. */
int stator_chip_watch(stator_chip *chip, uint16_t lines);
/* The next change of a watched line: 1, with the change in `*event`; 0: none came within
 * `timeout_ms` (below 0: wait for ever). Changes that come during other calls are kept; if more
 * than 256 are, the eldest are merged. */
int stator_chip_wait_event(stator_chip *chip, stator_chip_event *event, int timeout_ms);
/* Asks for the levels of all lines now. */
int stator_chip_levels(stator_chip *chip, uint16_t *levels);
/* Time of the simulation at the last answer, ns. */
uint64_t stator_chip_time(const stator_chip *chip);

/* Drives a pin of the chip (STATOR_PIN_...). */
int stator_chip_set_pin(stator_chip *chip, unsigned pin, int level);
/* A low pulse at NRESET. */
int stator_chip_reset(stator_chip *chip);
/* Switches the supply of the device. */
int stator_chip_power(stator_chip *chip, int on);

#ifdef __cplusplus
}
#endif

#endif
