// Fields of encoder, SPI master and I2C master, registers 0..17.

#include "stator/mfc/registers/register_fields.hpp"

namespace stator::mfc {

namespace {

using namespace notation;

// {register, highest bit, lowest bit, name, master, controller, range, lines, meaning, reset}
constexpr RegisterField kFields[] = {
    {0, 0, 0, "pol_A", rw, rw, "0..1", "L6450-L6454",
     "A level required for N event (0 neg, 1 pos)"},
    {0, 1, 1, "pol_B", rw, rw, "0..1", "L6456-L6460", "B level required for N event"},
    {0, 2, 2, "pol_N", rw, rw, "0..1", "L6462-L6466", "active level of N"},
    {0, 3, 3, "ignore_AB", rw, rw, "0..1", "L6468-L6476", "1=A/B levels ignored for N event"},
    {0, 4, 4, "clr_cont", rw, rw, "0..1", "L6478-L6486",
     "1=latch (or latch+clear) at every N event"},
    {0, 5, 5, "clr_once", rw, rw, "0..1", "L6488-L6494",
     "1=latch (or latch+clear) at next N event after the write"},
    {0, 6, 6, "pos_edge", rw, rw, "0..1", "L6496-L6504",
     "p of np pair: 00 level, 01 N going active, 10 N going inactive, 11 both"},
    {0, 7, 7, "neg_edge", rw, rw, "0..1", "L6496-L6504", "n of np pair"},
    {0, 8, 8, "clr_enc_x", rw, rw, "0..1", "L6506-L6512", "0=latch only 1=latch and clear X_ENC"},
    {0, 9, 9, "latch_x_act", rw, rw, "0..1", "L6514-L6522",
     "also latch XACTUAL; no ramp generator in this device, no effect"},
    {0, 10, 10, "enc_sel_decimal", rw, rw, "0..1", "L6524-L6534",
     "0=binary prescaler /65536 1=decimal /10000"},
    {0, 15, 11, "reserved", no, no, "", "L6536", ""},
    {1, 0, 0, "n_event", r_c, r_c, "0..1", "L6543-L6553", "N event detected; cleared on read"},
    {1, 7, 1, "reserved", r, r, "", "L6555", ""},
    {2, 31, 0, "X_ENC", rw, rw, "-2147483648..2147483647", "L6563", "signed; write view"},
    {3, 31, 0, "X_ENC", r, r, "-2147483648..2147483647", "L6571", "signed; read view"},
    {4, 31, 0, "ENC_CONST", rw, rw, "binary +/-(0..32767.9999847) decimal +/-(0..32767.9999)",
     "L6579-L6607",
     "signed 16.16 (binary) or 16 bit . 0..9999 (decimal); reset default 65536 = 1.0", 65536},
    {5, 31, 0, "ENC_LATCH", r, r, "-2147483648..2147483647", "L6614", "X_ENC latched at N event"},
    {6, 63, 0, "SPI_RX_DATA", r, r, "", "L6623-L6629",
     "last received datagram, upper bits unused when shorter than 64"},
    {7, 63, 0, "SPI_TX_DATA", w, w, "", "L6637-L6655",
     "write of highest used byte starts transfer when trigger=0; all bytes in one access"},
    {8, 1, 0, "slave_select", rw, rw, "0..3", "L6661", "chip select line"},
    {8, 2, 2, "reserved", rw, rw, "", "L6663", ""},
    {8, 3, 3, "keep_cs_low", rw, rw, "0..1", "L6665-L6669",
     "hold CS after transfer, for datagrams over 64 bit"},
    {8, 4, 4, "lsb_first", rw, rw, "0..1", "L6671", ""},
    {8, 5, 5, "clock_phase", rw, rw, "0..1", "L6673", "CPHA"},
    {8, 6, 6, "clock_polarity", rw, rw, "0..1", "L6675", "CPOL"},
    {8, 7, 7, "reserved", rw, rw, "", "L6677", ""},
    {8, 10, 8, "start_trigger", rw, rw, "0..7", "L6680-L6691",
     "0=TX write 1=PWM begin 2=PWM center 3=PWM A 4=PWM B 5=PWM A and B marks 6=reserved 7=single "
     "trigger bit 15"},
    {8, 14, 11, "reserved", rw, rw, "", "L6693", ""},
    {8, 15, 15, "single_trigger", rw, rw, "0..1", "L6695-L6699", "start once when start_trigger=7"},
    {9, 0, 0, "ready", r, r, "0..1", "L6707", "1=transfer done, ready for next"},
    {9, 7, 1, "unused", r, r, "0", "L6709", ""},
    {10, 5, 0, "spi_length", w, w, "0..63", "L6717-L6722", "datagram bits = value + 1"},
    {10, 7, 6, "unused", w, w, "0", "L6724", ""},
    {11, 7, 0, "spi_bit_duration", w, w, "0..255", "L6732-L6737", "fSPI = 25 MHz / (4 + 2*value)"},
    {12, 7, 0, "i2c_bit_duration", w, w, "0..255 us", "L6746-L6751", "0=off"},
    {13, 0, 0, "receive_nack", w, w, "0..1", "L6759", "receive data, answer NACK"},
    {13, 1, 1, "receive_ack", w, w, "0..1", "L6761", "receive data, answer ACK"},
    {13, 2, 2, "send_data", w, w, "0..1", "L6763", "send I2C_DATA_W"},
    {13, 3, 3, "send_address", w, w, "0..1", "L6765-L6769", "send I2C_ADDRESS incl. R/nW"},
    {13, 4, 4, "send_stop", w, w, "0..1", "L6771", ""},
    {13, 5, 5, "send_start", w, w, "0..1", "L6773", "start or repeated start"},
    {13, 7, 6, "unused", w, w, "", "L6775", ""},
    {14, 0, 0, "St", r, r, "0..1", "L6783", "start sent"},
    {14, 1, 1, "RSt", r, r, "0..1", "L6785", "repeated start sent"},
    {14, 2, 2, "ADR", r, r, "0..1", "L6787", "transmit address mode"},
    {14, 3, 3, "RX", r, r, "0..1", "L6789", "read from slave mode"},
    {14, 4, 4, "TX", r, r, "0..1", "L6791", "write to slave mode"},
    {14, 5, 5, "ACK", r, r, "0..1", "L6793", "acknowledge received/sent"},
    {14, 6, 6, "NAK", r, r, "0..1", "L6795", "not acknowledge received/sent"},
    {14, 7, 7, "ERR", r, r, "0..1", "L6797", "error flag"},
    {15, 0, 0, "rnw", w, w, "0..1", "L6804", "1=read 0=write"},
    {15, 7, 1, "address", w, w, "0..127", "L6806", "7-bit slave address"},
    {16, 7, 0, "data_r", r, r, "0..255", "L6814", ""},
    {17, 7, 0, "data_w", w, w, "0..255", "L6822", ""},
};

}  // namespace

std::span<const RegisterField> encoder_and_serial_fields() {
  return kFields;
}

}  // namespace stator::mfc
