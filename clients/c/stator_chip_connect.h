/* Of the library's own: sockets as people write them. */
#ifndef STATOR_CHIP_CONNECT_H
#define STATOR_CHIP_CONNECT_H

/* Connects to "unix:PATH" or "tcp:HOST:PORT". A descriptor, or -1 with errno; EINVAL for another
 * form. */
int stator_chip_connect(const char *address);

#endif
