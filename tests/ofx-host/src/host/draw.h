// What the overlay drew with the last event.
#pragma once

#include "library.h"

#include <string>
#include <vector>

namespace rototoon_host {

// The numbers of each line: whether it is closed, the number of its points, and their coordinates.
std::vector<double> &drawn_lines();
// Red, green, blue, opacity and width of each line.
std::vector<float> &line_colours();
std::vector<std::string> &drawn_texts();

// The suite for drawing that the host gives to plugins.
const OfxDrawSuiteV1 *draw_suite();

} // namespace rototoon_host
