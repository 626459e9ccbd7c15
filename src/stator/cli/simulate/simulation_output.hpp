#pragma once

#include <string>

#include "stator/experiment/result.hpp"

namespace stator::cli {

/// Prints remarks and a table of measured values beside those of the equations.
void print_comparisons(const experiment::Result& result);

/// Writes all panels side by side into one CSV file, each with its x first; shorter ones end in
/// empty fields, as do points at which nothing was measured. Throws Failure.
void write_csv(const experiment::Result& result, const std::string& path);

/// Draws the panels into `image_path` (.svg or .png) from the file written by write_csv().
void draw(const experiment::Result& result, const std::string& csv_path,
          const std::string& image_path);

}  // namespace stator::cli
