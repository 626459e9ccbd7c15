/*
 * A CANopen master in C on SocketCAN, as a user has one: it starts node 1, turns its drive by SDOs and reads
 * the velocity. Nothing in it knows Stator.
 *
 *   cc -o can_master can_master.c
 *   stator can-exec -- ./can_master can0
 */
#define _DEFAULT_SOURCE

#include <net/if.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <linux/can.h>
#include <linux/can/raw.h>

enum { NODE = 1, TIME_LIMIT_S = 60 };

static int bus;

static void fail(const char *what) {
  perror(what);
  exit(1);
}

static void open_bus(const char *interface) {
  struct ifreq request = {0};
  struct sockaddr_can address = {.can_family = AF_CAN};
  const struct timeval limit = {.tv_sec = TIME_LIMIT_S};
  bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  if (bus < 0) fail("socket");
  strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
  if (ioctl(bus, SIOCGIFINDEX, &request) != 0) fail(interface);
  address.can_ifindex = request.ifr_ifindex;
  if (bind(bus, (struct sockaddr *)&address, sizeof address) != 0) fail("bind");
  if (setsockopt(bus, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) != 0) fail("time limit");
}

static void send_frame(uint32_t identifier, const uint8_t *data, uint8_t length) {
  struct can_frame frame = {.can_id = identifier, .can_dlc = length};
  memcpy(frame.data, data, length);
  if (write(bus, &frame, sizeof frame) != sizeof frame) fail("write");
}

static void receive(struct can_frame *frame, const char *what) {
  if (read(bus, frame, sizeof *frame) != sizeof *frame) fail(what);
}

/* A drive that still boots hears nothing; its boot-up message and its heartbeats have the same identifier. */
static void wait_for_drive(void) {
  struct can_frame frame;
  do {
    receive(&frame, "no heartbeat of the drive");
  } while (frame.can_id != 0x700 + NODE);
}

/* An expedited SDO request and the data of its answer. */
static int32_t sdo(uint8_t command, uint16_t index, int32_t value) {
  struct can_frame answer;
  uint8_t data[8] = {command, (uint8_t)index, (uint8_t)(index >> 8), 0};
  memcpy(data + 4, &value, sizeof value);
  send_frame(0x600 + NODE, data, sizeof data);
  do {
    receive(&answer, "no answer of the drive");
  } while (answer.can_id != 0x580 + NODE || memcmp(answer.data + 1, data + 1, 3) != 0);
  memcpy(&value, answer.data + 4, sizeof value);
  if (answer.data[0] == 0x80) {
    fprintf(stderr, "%04Xh: the drive aborts with %08Xh\n", (unsigned)index, (unsigned)value);
    exit(1);
  }
  return value;
}

static int32_t read_object(uint16_t index) { return sdo(0x40, index, 0); }
static void write_1_byte(uint16_t index, int32_t value) { sdo(0x2F, index, value); }
static void write_2_bytes(uint16_t index, int32_t value) { sdo(0x2B, index, value); }
static void write_4_bytes(uint16_t index, int32_t value) { sdo(0x23, index, value); }

int main(int count, char **arguments) {
  enum { VELOCITY = 500, TOLERANCE = 25, LOOKS = 600 };
  const uint8_t start_all_nodes[] = {1, 0};
  int32_t velocity = 0;
  int looks;
  open_bus(count > 1 ? arguments[1] : "can0");
  wait_for_drive();
  send_frame(0, start_all_nodes, sizeof start_all_nodes);
  write_1_byte(0x6060, 3); /* profile velocity */
  write_2_bytes(0x6040, 0x06);
  write_2_bytes(0x6040, 0x07);
  write_2_bytes(0x6040, 0x0F);
  write_4_bytes(0x60FF, VELOCITY);
  for (looks = 0; looks < LOOKS && abs(velocity - VELOCITY) > TOLERANCE; ++looks) {
    usleep(100000);
    velocity = read_object(0x606C);
  }
  printf("statusword %04Xh, %d rpm\n", (unsigned)read_object(0x6041) & 0xFFFFu, (int)velocity);
  return abs(velocity - VELOCITY) > TOLERANCE;
}
