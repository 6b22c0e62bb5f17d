// Records the lines that the overlay draws, with the suite for drawing or with OpenGL.

#include "draw.h"

namespace rototoon_host {

std::vector<double> &drawn_lines() {
  static std::vector<double> lines;
  return lines;
}
std::vector<float> &line_colours() {
  static std::vector<float> colours;
  return colours;
}
std::vector<std::string> &drawn_texts() {
  static std::vector<std::string> texts;
  return texts;
}

namespace {

float current_colour[4] = {1, 1, 1, 1};
float current_width = 1;
void begin_line() {
  line_colours().insert(line_colours().end(), current_colour, current_colour + 4);
  line_colours().push_back(current_width);
}
size_t gl_line = 0;
// Whether each pair of points is a line of its own, and the number of points since the beginning.
bool gl_pairs = false;
size_t gl_points = 0;
void gl_new_line(bool closed) {
  begin_line();
  gl_line = drawn_lines().size();
  drawn_lines().push_back(closed);
  drawn_lines().push_back(0);
}

} // namespace

// The plugin looks these functions up in the process of its host.
extern "C" {
void glBegin(unsigned mode) {
  gl_pairs = mode == 1, gl_points = 0;
  if (!gl_pairs) gl_new_line(mode == 2);
}
void glEnd() {}
void glVertex2d(double x, double y) {
  if (gl_pairs && gl_points++ % 2 == 0) gl_new_line(false);
  drawn_lines()[gl_line + 1] += 1;
  drawn_lines().push_back(x);
  drawn_lines().push_back(y);
}
void glColor4f(float r, float g, float b, float a) {
  current_colour[0] = r, current_colour[1] = g, current_colour[2] = b, current_colour[3] = a;
}
void glLineWidth(float width) { current_width = width; }
void glPushAttrib(unsigned) {}
void glPopAttrib() {}
}

namespace {

OfxStatus draw_set_colour(OfxDrawContextHandle, const OfxRGBAColourF *c) {
  glColor4f(c->r, c->g, c->b, c->a);
  return kOfxStatOK;
}
OfxStatus draw_get_colour(OfxDrawContextHandle, OfxStandardColour, OfxRGBAColourF *) { return kOfxStatFailed; }
OfxStatus draw_set_width(OfxDrawContextHandle, float width) { return glLineWidth(width), kOfxStatOK; }
OfxStatus draw_set_stipple(OfxDrawContextHandle, OfxDrawLineStipplePattern) { return kOfxStatOK; }
OfxStatus draw_primitive(OfxDrawContextHandle, OfxDrawPrimitive primitive, const OfxPointD *points, int count) {
  begin_line();
  drawn_lines().push_back(primitive == kOfxDrawPrimitiveLineLoop);
  drawn_lines().push_back(count);
  for (int i = 0; i < count; ++i) {
    drawn_lines().push_back(points[i].x);
    drawn_lines().push_back(points[i].y);
  }
  return kOfxStatOK;
}
OfxStatus draw_text(OfxDrawContextHandle, const char *text, const OfxPointD *, int) {
  drawn_texts().push_back(text);
  return kOfxStatOK;
}
OfxDrawSuiteV1 draw_suite_v1 = {draw_get_colour, draw_set_colour, draw_set_width,
                                draw_set_stipple, draw_primitive, draw_text};

} // namespace

const OfxDrawSuiteV1 *draw_suite() { return &draw_suite_v1; }

} // namespace rototoon_host
