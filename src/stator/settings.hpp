#pragma once

/// @file
/// Configuration as data: trees of values (stator::settings::Value), and keys that are declared
/// beside the structs they fill (stator::settings::Key, Section, number(), whole(), keys() ...),
/// from which reading, messages, schema and reference follow.

#include "stator/settings/key.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/reader.hpp"
#include "stator/settings/section.hpp"
#include "stator/settings/value.hpp"
