#define _POSIX_C_SOURCE 200809L

#include "stator_chip.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "stator_chip_connect.h"

/* The protocol: docs/how-to/firmware-on-a-socket.md. */
enum {
  HEADER = 4,
  STATUS = 12,
  TRANSFER_PREFIX = 4,
  EVENT_LENGTH = 16,
  MAXIMUM_BODY = STATUS + (int)STATOR_CHIP_MAXIMUM_TRANSFER,
  KEPT_EVENTS = 256
};
enum {
  KIND_HELLO = 0x01,
  KIND_TRANSFER = 0x02,
  KIND_LEVELS = 0x03,
  KIND_WATCH = 0x04,
  KIND_PIN = 0x05,
  KIND_POWER = 0x06,
  KIND_REPLY = 0x80,
  KIND_EVENT = 0xC0,
  KIND_ERROR = 0xFF
};
enum { FLAG_KEEP_SELECTED = 0x01, FLAG_PAUSE = 0x02 };
enum { HELLO_LENGTH = 5, VERSION = 1, HELLO_CONTENT = 6 };

struct stator_chip {
  int socket;
  uint8_t tag;
  long read_pause;
  uint64_t time;
  uint16_t levels;
  char name[256];
  char error[320];
  stator_chip_event events[KEPT_EVENTS];
  unsigned first_event;
  unsigned event_count;
  uint8_t out[HEADER + TRANSFER_PREFIX + STATOR_CHIP_MAXIMUM_TRANSFER];
  uint8_t in[HEADER + MAXIMUM_BODY];
  size_t received; /* bytes of the next message that are in `in` */
};

static uint16_t load16(const uint8_t *bytes) { return (uint16_t)(bytes[0] | bytes[1] << 8); }

static uint64_t load64(const uint8_t *bytes) {
  uint64_t value = 0;
  for (int i = 7; i >= 0; --i) {
    value = value << 8 | bytes[i];
  }
  return value;
}

static void store16(uint8_t *bytes, unsigned value) {
  bytes[0] = (uint8_t)value;
  bytes[1] = (uint8_t)(value >> 8);
}

static int fail(stator_chip *chip, int code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(chip->error, sizeof chip->error, format, arguments);
  va_end(arguments);
  if (code == STATOR_CHIP_CLOSED && chip->socket >= 0) {
    close(chip->socket);
    chip->socket = -1;
  }
  return code;
}

static int64_t milliseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* A change that does not fit joins the last one, so that no edge of a line is forgotten. */
static void keep_event(stator_chip *chip, const uint8_t *body) {
  const stator_chip_event event = {.levels = load16(body),
                                   .rose = load16(body + 2),
                                   .fell = load16(body + 4),
                                   .lost = load16(body + 6),
                                   .time_ns = load64(body + 8)};
  if (chip->event_count == KEPT_EVENTS) {
    const unsigned second = (chip->first_event + 1) % KEPT_EVENTS;
    chip->events[second].rose |= chip->events[chip->first_event].rose;
    chip->events[second].fell |= chip->events[chip->first_event].fell;
    chip->events[second].lost =
        (uint16_t)(chip->events[second].lost + chip->events[chip->first_event].lost + 1);
    chip->first_event = second;
    --chip->event_count;
  }
  chip->events[(chip->first_event + chip->event_count) % KEPT_EVENTS] = event;
  ++chip->event_count;
  chip->levels = event.levels;
  chip->time = event.time_ns;
}

/* Waits for bytes until `end` (of milliseconds(); below 0: for ever). 1: some came, 0: none. */
static int receive(stator_chip *chip, size_t wanted, int64_t end) {
  for (;;) {
    const ssize_t length = recv(chip->socket, chip->in + chip->received, wanted - chip->received,
                                MSG_DONTWAIT);
    if (length > 0) {
      chip->received += (size_t)length;
      return 1;
    }
    if (length == 0) {
      return fail(chip, STATOR_CHIP_CLOSED, "the chip's side has closed the connection");
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
      return fail(chip, STATOR_CHIP_CLOSED, "the connection broke: %s", strerror(errno));
    }
    int timeout = -1;
    if (end >= 0) {
      const int64_t left = end - milliseconds();
      if (left <= 0) {
        timeout = 0;
      } else {
        timeout = left > 1000000 ? 1000000 : (int)left;
      }
    }
    struct pollfd waiting = {.fd = chip->socket, .events = POLLIN, .revents = 0};
    const int ready = poll(&waiting, 1, timeout);
    if (ready == 0) {
      if (end >= 0 && milliseconds() >= end) {
        return 0;
      }
    } else if (ready < 0 && errno != EINTR) {
      return fail(chip, STATOR_CHIP_CLOSED, "cannot wait for the chip: %s", strerror(errno));
    }
  }
}

/* One whole message in chip->in; its kind, 0: none in time. Its body is chip->in + HEADER. */
static int next_message(stator_chip *chip, size_t *length, int64_t end) {
  for (;;) {
    size_t wanted = HEADER;
    if (chip->received >= HEADER) {
      const size_t body = load16(chip->in);
      if (body > MAXIMUM_BODY) {
        return fail(chip, STATOR_CHIP_CLOSED, "the other side does not speak this protocol");
      }
      wanted += body;
      if (chip->received == wanted) {
        *length = body;
        chip->received = 0;
        return chip->in[2];
      }
    }
    const int came = receive(chip, wanted, end);
    if (came <= 0) {
      return came;
    }
  }
}

static int refused(stator_chip *chip, size_t length) {
  const int ends = length > 0 && (chip->in[HEADER] == 1 || chip->in[HEADER] == 4 ||
                                  chip->in[HEADER] == 6 || chip->in[HEADER] == 7);
  const int text = length > 1 ? (int)(length - 1) : 0;
  return fail(chip, ends ? STATOR_CHIP_CLOSED : STATOR_CHIP_REFUSED, "%.*s", text,
              (const char *)chip->in + HEADER + 1);
}

static int send_all(stator_chip *chip, size_t length) {
  size_t sent = 0;
  while (sent < length) {
    const ssize_t count = send(chip->socket, chip->out + sent, length - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += (size_t)count;
    } else if (count < 0 && errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

/* Sends the request whose body is in chip->out and waits for its answer; the length of the answer's
 * own content, which is chip->in + HEADER + STATUS. */
static int request(stator_chip *chip, int kind, size_t body) {
  if (chip->socket < 0) {
    return STATOR_CHIP_CLOSED;
  }
  chip->error[0] = '\0';
  store16(chip->out, (unsigned)body);
  chip->out[2] = (uint8_t)kind;
  chip->out[3] = ++chip->tag;
  const int broken = send_all(chip, HEADER + body);
  /* Whoever turned us away has said why before that. */
  for (;;) {
    size_t length = 0;
    const int answer = next_message(chip, &length, -1);
    if (answer < 0) {
      return broken != 0 ? fail(chip, STATOR_CHIP_CLOSED, "the connection broke: %s",
                                strerror(broken))
                         : answer;
    }
    if (answer == KIND_EVENT && length == EVENT_LENGTH) {
      keep_event(chip, chip->in + HEADER);
    } else if (answer == KIND_ERROR) {
      return refused(chip, length);
    } else if (answer == (kind | KIND_REPLY) && chip->in[3] == chip->tag && length >= STATUS) {
      chip->levels = load16(chip->in + HEADER);
      chip->time = load64(chip->in + HEADER + 4);
      return (int)(length - STATUS);
    } else {
      return fail(chip, STATOR_CHIP_CLOSED, "the other side does not speak this protocol");
    }
  }
}

static void explain(char *error, size_t size, const char *address, const char *reason) {
  if (error != NULL && size != 0) {
    snprintf(error, size, "cannot reach a chip at \"%s\": %s", address, reason);
  }
}

stator_chip *stator_chip_open(const char *address, char *error, size_t size) {
  const int connection = stator_chip_connect(address);
  if (connection < 0) {
    explain(error, size, address,
            errno == EINVAL ? "write unix:PATH or tcp:HOST:PORT" : strerror(errno));
    return NULL;
  }
  stator_chip *chip = calloc(1, sizeof *chip);
  if (chip == NULL) {
    explain(error, size, address, "no memory");
    close(connection);
    return NULL;
  }
  chip->socket = connection;
  chip->read_pause = -1;
  memcpy(chip->out + HEADER, "STCH", 4);
  chip->out[HEADER + 4] = VERSION;
  const int content = request(chip, KIND_HELLO, HELLO_LENGTH);
  if (content < HELLO_CONTENT) {
    explain(error, size, address,
            content < 0 ? chip->error : "the other side does not speak this protocol");
    stator_chip_close(chip);
    return NULL;
  }
  size_t name = (size_t)content - HELLO_CONTENT;
  if (name >= sizeof chip->name) {
    name = sizeof chip->name - 1;
  }
  memcpy(chip->name, chip->in + HEADER + STATUS + HELLO_CONTENT, name);
  return chip;
}

void stator_chip_close(stator_chip *chip) {
  if (chip == NULL) {
    return;
  }
  if (chip->socket >= 0) {
    close(chip->socket);
  }
  free(chip);
}

const char *stator_chip_error(const stator_chip *chip) { return chip->error; }
const char *stator_chip_name(const stator_chip *chip) { return chip->name; }
int stator_chip_descriptor(const stator_chip *chip) { return chip->socket; }
uint64_t stator_chip_time(const stator_chip *chip) { return chip->time; }

void stator_chip_set_read_pause(stator_chip *chip, long nanoseconds) {
  chip->read_pause = nanoseconds;
}

int stator_chip_spi_piece(stator_chip *chip, unsigned port, const void *tx, void *rx, size_t length,
                          int keep_selected) {
  if (length > STATOR_CHIP_MAXIMUM_TRANSFER || port > 0xFF) {
    return fail(chip, STATOR_CHIP_MISUSE, "a transfer has at most %u bytes",
                STATOR_CHIP_MAXIMUM_TRANSFER);
  }
  uint8_t *body = chip->out + HEADER;
  const long pause = chip->read_pause > 0xFFFF ? 0xFFFF : chip->read_pause;
  body[0] = (uint8_t)port;
  body[1] = (uint8_t)((keep_selected ? FLAG_KEEP_SELECTED : 0) | (pause >= 0 ? FLAG_PAUSE : 0));
  store16(body + 2, pause >= 0 ? (unsigned)pause : 0);
  if (tx != NULL) {
    memcpy(body + TRANSFER_PREFIX, tx, length);
  } else {
    memset(body + TRANSFER_PREFIX, 0, length);
  }
  const int answered = request(chip, KIND_TRANSFER, TRANSFER_PREFIX + length);
  if (answered < 0) {
    return answered;
  }
  if ((size_t)answered != length) {
    return fail(chip, STATOR_CHIP_CLOSED, "the other side does not speak this protocol");
  }
  if (rx != NULL) {
    memcpy(rx, chip->in + HEADER + STATUS, length);
  }
  return answered;
}

int stator_chip_spi_transfer(stator_chip *chip, unsigned port, const void *tx, void *rx,
                             size_t length) {
  return stator_chip_spi_piece(chip, port, tx, rx, length, 0);
}

int stator_chip_watch(stator_chip *chip, uint16_t lines) {
  store16(chip->out + HEADER, lines);
  const int answered = request(chip, KIND_WATCH, 2);
  return answered < 0 ? answered : 0;
}

static int take_event(stator_chip *chip, stator_chip_event *event) {
  if (chip->event_count == 0) {
    return 0;
  }
  *event = chip->events[chip->first_event];
  chip->first_event = (chip->first_event + 1) % KEPT_EVENTS;
  --chip->event_count;
  return 1;
}

int stator_chip_wait_event(stator_chip *chip, stator_chip_event *event, int timeout_ms) {
  if (take_event(chip, event)) {
    return 1;
  }
  if (chip->socket < 0) {
    return STATOR_CHIP_CLOSED;
  }
  const int64_t end = timeout_ms < 0 ? -1 : milliseconds() + timeout_ms;
  size_t length = 0;
  const int kind = next_message(chip, &length, end);
  if (kind <= 0) {
    return kind;
  }
  if (kind == KIND_ERROR) {
    return refused(chip, length);
  }
  if (kind != KIND_EVENT || length != EVENT_LENGTH) {
    return fail(chip, STATOR_CHIP_CLOSED, "the other side does not speak this protocol");
  }
  keep_event(chip, chip->in + HEADER);
  return take_event(chip, event);
}

int stator_chip_levels(stator_chip *chip, uint16_t *levels) {
  const int answered = request(chip, KIND_LEVELS, 0);
  if (answered < 0) {
    return answered;
  }
  *levels = chip->levels;
  return 0;
}

int stator_chip_set_pin(stator_chip *chip, unsigned pin, int level) {
  chip->out[HEADER] = (uint8_t)(pin > 0xFF ? 0xFF : pin);
  chip->out[HEADER + 1] = (uint8_t)(level != 0);
  const int answered = request(chip, KIND_PIN, 2);
  return answered < 0 ? answered : 0;
}

int stator_chip_reset(stator_chip *chip) {
  const int low = stator_chip_set_pin(chip, STATOR_PIN_NRESET, 0);
  return low < 0 ? low : stator_chip_set_pin(chip, STATOR_PIN_NRESET, 1);
}

int stator_chip_power(stator_chip *chip, int on) {
  chip->out[HEADER] = (uint8_t)(on != 0);
  const int answered = request(chip, KIND_POWER, 1);
  return answered < 0 ? answered : 0;
}
