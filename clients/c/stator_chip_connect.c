#define _POSIX_C_SOURCE 200809L

#include "stator_chip_connect.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static int connect_unix(const char *path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  if (strlen(path) >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  memcpy(address.sun_path, path, strlen(path));
  const int connection = socket(AF_UNIX, SOCK_STREAM, 0);
  if (connection >= 0 &&
      connect(connection, (const struct sockaddr *)&address, sizeof address) != 0) {
    const int reason = errno;
    close(connection);
    errno = reason;
    return -1;
  }
  return connection;
}

static int connect_tcp(const char *place) {
  char host[256];
  const char *colon = strrchr(place, ':');
  const size_t length = colon != NULL ? (size_t)(colon - place) : 0;
  if (length == 0 || length >= sizeof host) {
    errno = EINVAL;
    return -1;
  }
  memcpy(host, place, length);
  host[length] = '\0';
  const struct addrinfo wanted = {.ai_socktype = SOCK_STREAM};
  struct addrinfo *found = NULL;
  if (getaddrinfo(host, colon + 1, &wanted, &found) != 0) {
    errno = EHOSTUNREACH;
    return -1;
  }
  int connection = -1;
  for (const struct addrinfo *each = found; each != NULL && connection < 0; each = each->ai_next) {
    connection = socket(each->ai_family, each->ai_socktype, each->ai_protocol);
    if (connection >= 0 && connect(connection, each->ai_addr, each->ai_addrlen) != 0) {
      const int reason = errno;
      close(connection);
      connection = -1;
      errno = reason;
    }
  }
  freeaddrinfo(found);
  if (connection >= 0) {
    const int on = 1;
    setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  return connection;
}

int stator_chip_connect(const char *address) {
  if (strncmp(address, "unix:", 5) == 0) {
    return connect_unix(address + 5);
  }
  if (strncmp(address, "tcp:", 4) == 0) {
    return connect_tcp(address + 4);
  }
  errno = EINVAL;
  return -1;
}
