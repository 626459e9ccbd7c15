#pragma once

/// @file
/// The slave controller alone, for a slave stack of one's own or of somebody else: the stack
/// reaches stator::ethercat::SlaveController through stator::ethercat::ProcessDataInterface, as it
/// reaches a real one over SPI; stator::ethercat::Segment is the cable. stator::master::Master with
/// a stator::master::FramePort is a master for tests in the same process.

#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/controller/slave_controller_configuration.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"
#include "stator/ethercat/units/sii_interface.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/master/master.hpp"
