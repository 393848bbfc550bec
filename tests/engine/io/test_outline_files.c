/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines from SVG and DXF and back: shapes of known area, commands against their absolute or
 * longer forms, units, transforms, chaining, what was written comes back, refusals with their
 * lines. */
#include <locale.h>
#include <unistd.h>

#include "../outline/shapes.h"
#include "io_check.h"

#define PI 3.14159265358979323846

static bw_status parse(bw_context *context, const char *name, const char *text, double unit,
                       bw_outline **outline) {
  const bw_outline_read_options options = {unit, 0};
  bw_read_info info;
  return bw_outline_parse(context, name, (const unsigned char *)text, strlen(text), &options,
                          outline, &info);
}

static bw_outline_measures measure(bw_context *context, const bw_outline *o) {
  bw_outline_measures m;
  check_ok(context, bw_outline_measure(context, o, -1, &m));
  return m;
}

/* An SVG of unit pixels, one metre each, y up about 0. */
static bw_outline *svg(bw_context *context, const char *body) {
  char text[8000];
  bw_outline *o = NULL;
  snprintf(text, sizeof text, "<svg xmlns=\"http://www.w3.org/2000/svg\">%s</svg>", body);
  check_ok(context, parse(context, "a.svg", text, 1, &o));
  return o;
}

static void check_svg(bw_context *context, const char *body, double area, double x, double y,
                      double tolerance) {
  bw_outline *o = svg(context, body);
  bw_outline_measures m = measure(context, o);
  check_near(m.area, area, tolerance);
  check_near(m.centroid[0], x, tolerance);
  check_near(m.centroid[1], y, tolerance);
  bw_release(o);
}

static void shapes_of_svg(void **state) {
  bw_context *context = check_context(state);
  check_svg(context, "<rect x='1' y='2' width='4' height='6'/>", 24, 3, -5, 1e-13);
  check_svg(context, "<rect x='1' y='2' width='4' height='6' rx='1'/>", 24 - 4 + PI, 3, -5, 1e-4);
  check_svg(context, "<rect width='4' height='2' rx='9' ry='1'/>", 8 - 8 + 2 * PI, 2, -1, 1e-4);
  check_svg(context, "<circle cx='3' cy='-2' r='2'/>", 4 * PI, 3, 2, 1e-4);
  check_svg(context, "<ellipse cx='3' cy='-2' rx='2' ry='1'/>", 2 * PI, 3, 2, 1e-4);
  check_svg(context, "<polygon points='0,0 3,0 0,-3'/>", 4.5, 1, 1, 1e-14);
  check_svg(context, "<polyline points='0 0,3 0,0-3,0 0'/>", 4.5, 1, 1, 1e-14);
  check_svg(context,
            "<line x1='0' y1='0' x2='3' y2='0'/><line y1='-3'/><line x1='3' x2='0' y2='-3'/>", 4.5,
            1, 1, 1e-14);
}

static void paths_of_svg(void **state) {
  bw_context *context = check_context(state);
  /* the same square in many words */
  check_svg(context, "<path d='M0 0L2 0L2-2L0-2Z'/>", 4, 1, 1, 1e-14);
  check_svg(context, "<path d='M0,0H2V-2H0Z'/>", 4, 1, 1, 1e-14);
  check_svg(context, "<path d='m0 0h2v-2h-2z'/>", 4, 1, 1, 1e-14);
  check_svg(context, "<path d='M 0 0 2 0 2 -2 0 -2 0 0'/>", 4, 1, 1, 1e-14);
  check_svg(context, "<path d='m0 0 2,0 0-2-2 0z'/>", 4, 1, 1, 1e-14);
  check_svg(context, "<path d='M0 0l2e0.0 0-2-2+.0z'/>", 4, 1, 1, 1e-14);
  /* a parabola by Q, T, and as the cubics they are */
  check_svg(context, "<path d='M0 0Q1-2 2 0Z'/>", 4 / 3.0, 1, 0.4, 1e-14);
  check_svg(context, "<path d='M0 0q1-2 2 0t2 0 2 0 2 0V3H0Z'/>", 24, 4 - 2 / 9.0,
            -1.5 + 32 / 15.0 / 24, 1e-13); /* two waves */
  check_svg(context, "<path d='M0 0Q.5-1 1-1T2 0Z'/>", 4 / 3.0, 1, 0.4, 1e-14);
  check_svg(context, "<path d='M0 0C0-1 1-1 1-1S2-1 2 0Z'/>", 1.6, 1, 0.6 / 1.6 + 0.5 / 9.6, 1e-13);
  /* arcs: half circles, each way round, grown radii, flags without spaces */
  check_svg(context, "<path d='M0 0A1 1 0 0 0 2 0Z'/>", PI / 2, 1, -4 / (3 * PI), 1e-4);
  check_svg(context, "<path d='M0 0A1 1 0 0 1 2 0Z'/>", PI / 2, 1, 4 / (3 * PI), 1e-4);
  check_svg(context, "<path d='M0 0a.1.1 0 012 0z'/>", PI / 2, 1, 4 / (3 * PI), 1e-4);
  check_svg(context, "<path d='M0 0a2 1 90 012 0z'/>", PI, 1, 8 / (3 * PI), 1e-4);

  check_svg(context, "<path d='M1 0A1 1 0 1 0 0 1L0 0Z'/>", 0.75 * PI, -4 / (9 * PI) * 1,
            4 / (9 * PI) * 1, 1e-4);
  /* two loops in one path, the second relative to the start of the first after its Z */
  bw_outline *o = svg(context, "<path id='a' d='M0 0H9V9H0Zm1 1h2v2h-2z'/>");
  assert_int_equal(o->loop_count, 2);
  assert_string_equal(o->loop[0].name.text, "a");
  assert_string_equal(o->loop[1].name.text, "a 2");
  assert_int_equal(o->loop[1].region, -1);
  check_near(measure(context, o).area, 77, 1e-13);
  bw_release(o);
}

static void groups_and_units_of_svg(void **state) {
  bw_context *context = check_context(state);
  check_svg(context, "<g transform='translate(1,2) scale(2)'><rect width='1' height='1'/></g>", 4,
            2, -3, 1e-14);
  check_svg(context, "<g transform='rotate(90)'><rect width='2' height='1'/></g>", 2, -0.5, -1,
            1e-14);
  check_svg(context, "<g transform='rotate(90 1 1)'><rect width='2' height='1'/></g>", 2, 1.5, -1,
            1e-14);
  check_svg(context,
            "<g transform='matrix(1 2 3 4 5 6)'><rect width='1' height='1' "
            "transform='skewX(45),skewY(0)'/></g>",
            2, 7.5, -10, 1e-13);
  check_svg(context, "<svg x='3' y='1'><rect width='1' height='1'/></svg>", 1, 3.5, -1.5, 1e-14);
  check_svg(context, "<svg:g><svg:rect width='1' height='1'/></svg:g>", 1, 0.5, -0.5, 1e-14);
  check_svg(context,
            "<defs><rect width='9' height='9'/></defs><g display='none'><circle r='3'/></g>"
            "<rect style='fill:red;display : none' width='7' height='7'/>"
            "<!-- <rect/> --><title>x</title><rect width='1' height='1'/>",
            1, 0.5, -0.5, 1e-14);
  static const struct {
    const char *root;
    double side, x, y; /* of rect 0 0 10 20: width, low corner */
  } page[] = {
      {"width='100mm' height='50mm' viewBox='0 0 100 50'", 0.01, 0, 0.03},
      {"width='10cm' height='5cm' viewBox='0 0 100 50'", 0.01, 0, 0.03},
      {"width='1in' height='1in' viewBox='-5 -5 254 254'", 1e-3, 0, 1e-4 * (244 - 20)},
      {"width='96' height='192px'", 0.0254 * 10 / 96, 0, 0.0254 * 172 / 96},
      {"viewBox='0 0 96 96'", 0.0254 * 10 / 96, 0, 0.0254 * 76 / 96},
      {"width='100%' viewBox='0 0 96 96'", 0.0254 * 10 / 96, 0, 0.0254 * 76 / 96},
      {"width='72pt' height='6pc' viewBox='0 0 100 100'", 2.54e-3, 0, 0.0254 * 0.8},
  };
  for (size_t i = 0; i < sizeof page / sizeof *page; i++) {
    char text[300];
    bw_outline *o = NULL;
    snprintf(text, sizeof text,
             "<?xml version='1.0'?>\n<!DOCTYPE svg>\n<svg %s><rect width='10' height='20'/></svg>",
             page[i].root);
    check_ok(context, parse(context, "a.svg", text, 0, &o));
    bw_outline_measures m = measure(context, o);
    check_near(m.max[0] - m.min[0], page[i].side, 1e-15);
    check_near(m.max[1] - m.min[1], 2 * page[i].side, 1e-15);
    check_near(m.min[0], page[i].x, 1e-15);
    check_near(m.min[1], page[i].y, 1e-15);
    bw_release(o);
  }
}

static void names_and_tags_of_svg(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = svg(context, "<g class='free'><rect id='body' width='9' height='9'/>"
                               "<circle id='a&amp;b' class=' fixed grey ' cx='4' cy='4' r='2'/></g>"
                               "<rect id='body' x='20' width='1' height='1'/><rect x='3.5' y='3.5' "
                               "width='1' height='1' data-region='2'/>");
  check_outline(context, o);
  assert_int_equal(o->loop_count, 4);
  assert_string_equal(o->loop[1].name.text, "a&b");
  assert_string_equal(o->loop[2].name.text, "body 2");
  assert_string_equal(o->tag[o->segment[0].tag].text, "free");
  assert_string_equal(o->tag[o->segment[4].tag].text, "fixed");
  assert_string_equal(o->tag[o->segment[12].tag].text, "boundary");
  assert_int_equal(o->loop[1].region, -1);
  assert_int_equal(o->loop[3].region, 1);
  bw_release(o);
}

/* ---- DXF ------------------------------------------------------------------------------------- */

/* Pairs from a short form: "code value|code value|...". */
static bw_status dxf(bw_context *context, const char *header, const char *entities,
                     bw_outline **outline) {
  char text[8000];
  size_t length = 0;
  char all[4000];
  snprintf(all, sizeof all,
           "0 SECTION|2 HEADER|%s|0 ENDSEC|0 SECTION|2 ENTITIES|%s|0 ENDSEC|0 EOF|", header,
           entities);
  for (const char *c = all; *c;) {
    const char *blank = strchr(c, ' '), *bar = strchr(c, '|');
    length += (size_t)snprintf(text + length, sizeof text - length, "%3.*s\r\n%.*s\r\n",
                               (int)(blank - c), c, (int)(bar - blank - 1), blank + 1);
    c = bar + 1;
  }
  return parse(context, "a.dxf", text, 0, outline);
}

static void check_dxf(bw_context *context, const char *entities, double area, double x, double y,
                      double tolerance) {
  bw_outline *o = NULL;
  check_ok(context, dxf(context, "9 $INSUNITS|70 6", entities, &o));
  bw_outline_measures m = measure(context, o);
  check_near(m.area, area, tolerance);
  check_near(m.centroid[0], x, tolerance);
  check_near(m.centroid[1], y, tolerance);
  bw_release(o);
}

static void curves_of_dxf(void **state) {
  bw_context *context = check_context(state);
  const double turn = 4 * atan(0.5), bay = 25 / 32.0 * (turn - 0.96);
  check_dxf(context, "0 CIRCLE|8 a|10 3|20 4|40 2", 4 * PI, 3, 4, 1e-4);
  check_dxf(context, "0 CIRCLE|10 3|20 4|40 2|230 -1", 4 * PI, -3, 4, 1e-4);
  check_dxf(context, "0 ELLIPSE|10 3|20 4|11 0|21 2|40 0.5|41 0|42 6.283185307179586", 2 * PI, 3, 4,
            1e-4);
  check_dxf(context, "0 LWPOLYLINE|90 3|70 1|10 0|20 0|10 3|20 0|10 0|20 3", 4.5, 1, 1, 1e-14);
  /* two half circles of bulge 1; a bay of bulge -1/2: a segment of a circle of radius 5/4 */
  check_dxf(context, "0 LWPOLYLINE|70 1|10 0|20 0|42 1|10 2|20 0|42 1", PI, 1, 0, 1e-4);
  check_dxf(context, "0 LWPOLYLINE|70 1|10 0|20 0|42 -0.5|10 2|20 0|10 2|20 4|10 0|20 4", 8 - bay,
            1, (16 - bay * (2.56 / (3 * (turn - 0.96)) - 0.75)) / (8 - bay), 1e-4);

  check_dxf(context,
            "0 POLYLINE|66 1|70 1|8 a|0 VERTEX|10 0|20 0|42 0.414213562373095|0 VERTEX|10 1|20 1|0 "
            "VERTEX|10 0|20 1|0 SEQEND",
            PI / 4, 4 / (3 * PI), 1 - 4 / (3 * PI), 1e-4);
  /* a quarter of a disc from an arc and two lines, given in no order and any direction */
  check_dxf(context,
            "0 LINE|10 0|20 0|11 0|21 2|0 ARC|10 0|20 0|40 2|50 0|51 90|0 LINE|10 0|20 0|11 2|21 0",
            PI, 8 / (3 * PI), 8 / (3 * PI), 1e-4);
  check_dxf(context, "0 ARC|10 0|20 0|40 2|50 270|51 90|0 LINE|10 0|20 -2|11 0|21 2", 2 * PI,
            8 / (3 * PI), 0, 1e-4);
  /* splines: a cubic, a quadratic (the parabola of area 4/3), lines; a periodic one of degree 2
   * around the unit square's middle, whose area is known: 5/6 of the polygon of its points */
  check_dxf(
      context,
      "0 SPLINE|71 3|40 0|40 0|40 0|40 0|40 1|40 1|40 1|40 1|10 0|20 0|10 0.6666666666666666|20 "
      "1.3333333333333333|10 1.3333333333333333|20 1.3333333333333333|10 2|20 0|0 LINE|10 0|20 "
      "0|11 2|21 0",
      4 / 3.0, 1, 0.4, 1e-13);
  check_dxf(
      context,
      "0 SPLINE|71 2|40 0|40 0|40 0|40 1|40 1|40 1|10 0|20 0|10 1|20 2|10 2|20 0|0 LINE|10 0|20 "
      "0|11 2|21 0",
      4 / 3.0, 1, 0.4, 1e-13);
  check_dxf(context,
            "0 SPLINE|71 1|40 0|40 0|40 1|40 2|40 3|40 3|10 0|20 0|10 3|20 0|10 0|20 3|10 0|20 0",
            4.5, 1, 1, 1e-14);
  check_dxf(
      context,
      "0 SPLINE|70 11|71 2|40 0|40 1|40 2|40 3|40 4|40 5|40 6|40 7|40 8|10 0|20 0|10 1|20 0|10 "
      "1|20 1|10 0|20 1|10 0|20 0|10 1|20 0",
      5 / 6.0, 0.5, 0.5, 1e-13);
}

/* A uniform cubic B-spline on [3, 4] against its basis. */
static void splines_are_exact(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = NULL;
  check_ok(context,
           dxf(context, "9 $INSUNITS|70 6",
               "0 SPLINE|71 3|40 0|40 1|40 2|40 3|40 4|40 5|40 6|40 7|10 0|20 0|10 1|20 3|10 "
               "2|20 1|10 4|20 2|0 LINE|10 1|20 2.1666666666666665|11 1|21 0|0 LINE|10 1|20 0|11 "
               "2.1666666666666665|21 1.5",
               &o));
  const double p[4][2] = {{0, 0}, {1, 3}, {2, 1}, {4, 2}};
  for (int i = 0; i <= 10; i++) {
    double t = i / 10.0, at[2] = {0, 0};
    const double b[4] = {(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                         (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
    for (int j = 0; j < 4; j++)
      for (int k = 0; k < 2; k++)
        at[k] += b[j] * p[j][k];
    check_near(bw_outline_nearest(o, at).distance, 0, 1e-14);
  }
  bw_release(o);
}

static void layers_units_and_strangers_of_dxf(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = NULL;
  check_ok(context,
           dxf(context, "9 $ACADVER|1 AC1015|9 $INSUNITS|70 1",
               "0 TEXT|8 notes|1 hello|0 LWPOLYLINE|8 cut|70 1|10 0|20 0|10 4|20 0|10 4|20 4|10 "
               "0|20 4|0 CIRCLE|8 drill|10 2|20 2|40 1|0 CIRCLE|60 1|10 2|20 2|40 1.5",
               &o));
  check_outline(context, o);
  assert_int_equal(o->loop_count, 2);
  assert_int_equal(o->loop[1].region, -1);
  assert_string_equal(o->tag[o->segment[0].tag].text, "cut");
  assert_string_equal(o->tag[o->segment[4].tag].text, "drill");
  check_near(measure(context, o).max[0], 0.1016, 1e-15);
  assert_non_null(strstr(bw_warning_at(context, 0), "2 of 4 entities"));
  bw_clear_warnings(context);
  bw_release(o);
  check_ok(context, dxf(context, "9 $EXTMIN|10 0", "0 CIRCLE|10 2|20 2|40 1", &o));
  check_near(measure(context, o).max[0], 3e-3, 1e-15);
  assert_non_null(strstr(bw_warning_at(context, 0), "millimetres"));
  bw_clear_warnings(context);
  bw_release(o);
}

/* ---- there and back -------------------------------------------------------------------------- */

static bw_outline *rich(bw_context *context) {
  draft d = {0};
  draft_rectangle(&d, "body", 0, -0.1, 0.2, 0.7, 0.9);
  draft_circle(&d, "2nd <hole> & \"more\"", -1, 0.1 / 3, 0.5, 0.1);
  draft_rectangle(&d, "island", 1, 0.02, 0.49, 0.05, 0.51);
  draft_rectangle(&d, "inlay", 2, 0.3, 0.3, 0.5, 0.4);
  d.tags = 3;
  strcpy(d.tag[0].text, "free");
  strcpy(d.tag[1].text, "held fast");
  strcpy(d.tag[2].text, "\xC3\xA9t\xC3\xA9, 100%*");
  d.segment[3].tag = d.segment[1].tag = 1;
  for (int i = 5; i < 8; i++)
    d.segment[i].tag = 2;
  return draft_make(context, &d);
}

static bw_outline *there_and_back(bw_context *context, const bw_outline *o, const char *name) {
  char path[300];
  bw_outline *again = NULL;
  bw_read_info info;
  temporary(path, name);
  check_ok(context, bw_outline_write(context, o, path));
  check_ok(context, bw_outline_read(context, path, NULL, &again, &info));
  assert_null(bw_warning_at(context, 0));
  unlink(path);
  check_outline(context, again);
  return again;
}

static void svg_comes_back_as_it_was(void **state) {
  bw_context *context = check_context(state);
  setlocale(LC_ALL, "de_DE.UTF-8"); /* where it is installed, with decimal commas */
  bw_outline *o = rich(context), *again = there_and_back(context, o, "a.svg");
  setlocale(LC_ALL, "C");
  assert_int_equal(again->loop_count, o->loop_count);
  assert_int_equal(again->segment_count, o->segment_count);
  for (int32_t l = 0; l < o->loop_count; l++) {
    assert_string_equal(again->loop[l].name.text, o->loop[l].name.text);
    assert_int_equal(again->loop[l].region, o->loop[l].region);
    assert_int_equal(again->loop[l].parent, o->loop[l].parent);
  }
  for (int32_t s = 0; s < o->segment_count; s++) {
    assert_string_equal(again->tag[again->segment[s].tag].text, o->tag[o->segment[s].tag].text);
    for (int i = 0; i < 4; i++) {
      int32_t p = o->segment[s].point[i], q = again->segment[s].point[i];
      assert_int_equal(p < 0, q < 0);
      for (int k = 0; k < 2 && p >= 0; k++)
        check_near(again->point[2 * q + k], o->point[2 * p + k], 1e-15);
    }
  }
  bw_release(again);
  bw_release(o);
}

static void dxf_comes_back_with_its_layers(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = rich(context), *again = there_and_back(context, o, "a.dxf");
  assert_int_equal(again->segment_count, o->segment_count);
  for (int32_t s = 0; s < o->segment_count; s++) {
    double at[2];
    bw_outline_evaluate(o, s, 0.3, at, NULL, NULL);
    bw_outline_place place = bw_outline_nearest(again, at);
    check_near(place.distance, 0, 1e-15);
    /* the comma and the star are none of a layer's name */
    const char *tag = o->tag[o->segment[s].tag].text;
    assert_string_equal(again->tag[again->segment[place.segment].tag].text,
                        tag[0] == '\xC3' ? "\xC3\xA9t\xC3\xA9_ 100%_" : tag);
  }
  bw_release(again);
  bw_release(o);
}

/* ---- refusals -------------------------------------------------------------------------------- */

static void wrong_svg_is_refused(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *text, *message;
    bw_status status;
  } wrong[] = {
      {"", "the file is empty", BW_FORMAT},
      {"  \n", "no format that is read here", BW_FORMAT},
      {"<svg>\n<rect width='1'", "a.svg:2: the file ends inside the XML tag 'rect'", BW_FORMAT},
      {"<svg>\n<g><rect width='1' height='1'/></svg>",
       "</svg> where </g> was expected, for the element of line 2", BW_FORMAT},
      {"<svg>\n<g>", "ends inside the element 'g' of line 2", BW_FORMAT},
      {"<html><svg/></html>", "found 'html' where the element svg", BW_FORMAT},
      {"<svg/>", "it contains no curve", BW_FORMAT},
      {"<svg><path d='M1 1'/></svg>", "it contains no curve", BW_FORMAT},
      {"<svg><path d='M1 1Z'/></svg>", "it contains no curve", BW_FORMAT},
      {"<svg><path d='M1 1L1 1Z'/></svg>", "its curves have no length", BW_FORMAT},
      {"<svg>\n\n<path d='L1 1'/></svg>", "a.svg:3: found 'L1 1' where the M", BW_FORMAT},
      {"<svg>\n<path\n d='M0 0\nL1 x'/></svg>", "a.svg:4: found 'x' where a number", BW_FORMAT},
      {"<svg><path d='M0 0 L1'/></svg>", "ends inside the command 'L', which takes 2 numbers",
       BW_FORMAT},
      {"<svg><path d='M0 0 A1 1 0 2 0 1 1'/></svg>", "where a flag of an arc", BW_FORMAT},
      {"<svg><path d='M0 0 B1 1'/></svg>", "where a command of a path", BW_FORMAT},
      {"<svg><path d='M0 0 L1 1 Z 3 4'/></svg>", "where a command of a path", BW_FORMAT},
      {"<svg><path d='M0 0 L1e999 1'/></svg>", "where a number was expected", BW_FORMAT},
      {"<svg><rect width='-1' height='1'/></svg>", "a rect of -1 x 1", BW_FORMAT},
      {"<svg><circle r='1em'/></svg>", "found 'em' where a unit of length", BW_FORMAT},
      {"<svg><g transform='rotate(1,2)'><circle r='1'/></g></svg>", "'rotate' with 2 numbers",
       BW_FORMAT},
      {"<svg><g transform='turn(1)'><circle r='1'/></g></svg>", "'turn' with 1 numbers", BW_FORMAT},
      {"<svg><g transform='scale(1'><circle r='1'/></g></svg>", "no closing parenthesis",
       BW_FORMAT},
      {"<svg><polygon points='0 0 1'/></svg>", "the points end behind an x", BW_FORMAT},
      {"<svg viewBox='0 0 1'><circle r='1'/></svg>", "a viewBox of 3 numbers", BW_FORMAT},
      {"<svg viewBox='0 0 0 1'><circle r='1'/></svg>", "a viewBox of 0 x 1", BW_FORMAT},
      {"<svg>\n<path d='M0 0H1V1'/></svg>", "a.svg:2: a curve is open at", BW_GEOMETRY},
      {"<svg>\n<circle r='1'/>\n<circle cx='1' r='1'/></svg>", "a.svg:2: segment", BW_GEOMETRY},
      {"<svg>\n<path id='x' d='M0 0L1 1V0L0 1Z'/></svg>", "a.svg:2: segment 1 of loop 'x' crosses",
       BW_GEOMETRY},
      {"<svg><rect width='1' height='1' data-region='x'/></svg>", "'hole' or the number",
       BW_FORMAT},
      {"PK\x03\x04", "ZIP", BW_FORMAT},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    bw_outline *o = NULL;
    check_fails(context, wrong[i].status, wrong[i].message,
                parse(context, "a.svg", wrong[i].text, 0, &o));
    assert_null(o);
    bw_clear_warnings(context);
  }
}

static void wrong_dxf_is_refused(void **state) {
  bw_context *context = check_context(state);
  static const struct {
    const char *entities, *message;
    bw_status status;
  } wrong[] = {
      {"0 CIRCLE|10 1|20 x|40 1", "a.dxf:20: group 20: found 'x' where a number", BW_FORMAT},
      {"0 CIRCLE|10 1|20 1", "a CIRCLE without group 40", BW_FORMAT},
      {"0 CIRCLE|10 1|20 1|40 0", "a positive radius", BW_FORMAT},
      {"0 CIRCLE|10 1|20 1|40 1|210 1|230 0", "in a plane of direction (1, 0, 0)", BW_FORMAT},
      {"0 SPLINE|71 5|10 1|20 1", "its degree is not 1 to 3", BW_FORMAT},
      {"0 SPLINE|71 3|11 1|21 1", "fit points", BW_FORMAT},
      {"0 SPLINE|71 1|40 0|40 0|40 1|10 1|20 1|10 2|20 1", "number of its knots", BW_FORMAT},
      {"0 SPLINE|71 1|40 0|40 1|40 0|40 1|10 1|20 1|10 2|20 1", "do not increase", BW_FORMAT},
      {"0 SPLINE|71 1|40 0|40 0|40 0|40 0|10 1|20 1|10 2|20 1", "span nothing", BW_FORMAT},
      {"0 SPLINE|71 1|40 0|40 0|40 1|40 1|41 1|41 2|10 1|20 1|10 2|20 1", "rational", BW_FORMAT},
      {"0 SPLINE|71 1|40 0|40 0|40 1|40 1|10 1|20 1|10 2", "2 x and 1 y", BW_FORMAT},
      {"0 LWPOLYLINE|10 1|10 2|20 2", "the y of a vertex", BW_FORMAT},
      {"0 LINE|10 0|20 0|11 1|21 0", "a.dxf:16: a curve is open at (0, 0) m", BW_GEOMETRY},
      {"0 LINE|10 0|20 0|11 1|21 0|0 LINE|10 0|20 0|11 0|21 2|0 LINE|10 0|20 0|11 1|21 1|0 LINE|10 "
       "1|20 0|11 1|21 1",
       "more than two curves end at (", BW_GEOMETRY},
      {"0 TEXT|1 x", "contains no curve", BW_FORMAT},
      {"0 EOF", "where an entity or ENDSEC", BW_FORMAT},
      {"x LINE", "found 'x' where a group code", BW_FORMAT},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    bw_outline *o = NULL;
    check_fails(context, wrong[i].status, wrong[i].message,
                dxf(context, "9 $INSUNITS|70 6", wrong[i].entities, &o));
    assert_null(o);
    bw_clear_warnings(context);
  }
  bw_outline *o = NULL;
  check_fails(context, BW_FORMAT, "binary DXF",
              parse(context, "a.dxf", "AutoCAD Binary DXF\r\n\x1a", 0, &o));
  check_fails(context, BW_FORMAT, "its value is missing", parse(context, "a.dxf", "0", 0, &o));
  check_fails(context, BW_FORMAT, "cut short",
              parse(context, "a.dxf", "0\nSECTION\n2\nHEADER\n", 0, &o));
  check_fails(context, BW_FORMAT, "ENTITIES is missing",
              parse(context, "a.dxf", "0\nSECTION\n2\nHEADER\n0\nENDSEC\n0\nEOF\n", 0, &o));
  check_fails(context, BW_INVALID, ".svg or .dxf", bw_outline_write(context, o, "a.png"));
  check_fails(context, BW_INVALID, "positive lengths", parse(context, "a.dxf", "0", -1, &o));
  check_fails(context, BW_IO, "cannot be read",
              bw_outline_read(context, "/nowhere/a.svg", NULL, &o, NULL));
}

static void ends_are_put_together_within_the_tolerance(void **state) {
  bw_context *context = check_context(state);
  static const char text[] = "<svg><path d='M0 0H1V1'/><path d='M.999 1.001H0V0.0005'/></svg>";
  bw_outline_read_options options = {1, 0};
  bw_outline *o = NULL;
  check_fails(context, BW_GEOMETRY, "the nearest other end is 0.0005 m away",
              bw_outline_parse(context, "a.svg", (const unsigned char *)text, strlen(text),
                               &options, &o, NULL));
  options.tolerance = 0.01;
  check_ok(context, bw_outline_parse(context, "a.svg", (const unsigned char *)text, strlen(text),
                                     &options, &o, NULL));
  assert_int_equal(o->segment_count, 4);
  check_near(measure(context, o).area, 1, 3e-3);
  bw_release(o);
}

static void what_is_drawn_twice_is_dropped(void **state) {
  bw_context *context = check_context(state);
  bw_outline *o = NULL;
  check_ok(context, dxf(context, "9 $INSUNITS|70 6",
                        "0 LINE|10 0|20 0|11 3|21 0|0 LINE|10 3|20 0|11 0|21 0|0 LINE|10 3|20 0|11 "
                        "0|21 3|0 LINE|10 0|20 3|11 0|21 0|0 LINE|10 0|20 3|11 0|21 0|0 CIRCLE|10 "
                        "1|20 1|40 0.5|0 CIRCLE|10 1|20 1|40 0.5",
                        &o));
  assert_int_equal(o->loop_count, 2);
  check_near(measure(context, o).area, 4.5 - PI / 4, 1e-4);
  assert_non_null(strstr(bw_warning_at(context, 0), "3 curves coincide with others"));
  bw_clear_warnings(context);
  bw_release(o);
}

static void memory_failures_lose_nothing(void **state) {
  bw_context *context = check_context(state);
  static const char *const text[2] = {
      "<svg viewBox='0 0 9 9'><g class='x'><path id='a' d='M0 0H9V9'/><path data-tags='a b' d='M0 "
      "0V9H9'/></g>"
      "<circle cx='4' cy='4' r='1'/></svg>",
      "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\na\n10\n1\n20\n1\n40\n1\n0\nSPLINE\n71\n1\n40\n0\n40\n"
      "0\n40\n1\n40\n2\n40\n3\n40\n3\n10\n5\n20\n0\n10\n8\n20\n0\n10\n5\n20\n3\n10\n5\n20\n0\n0\nEN"
      "DSEC\n0\nEOF\n"};
  for (int i = 0; i < 2; i++)
    check_each_allocation(context, status, 1) {
      bw_outline *o = NULL;
      status = parse(context, i == 0 ? "a.svg" : "a.dxf", text[i], 0, &o);
      bw_clear_warnings(context);
      bw_release(o);
    }
}

check_main(check_test(shapes_of_svg), check_test(paths_of_svg), check_test(groups_and_units_of_svg),
           check_test(names_and_tags_of_svg), check_test(curves_of_dxf),
           check_test(splines_are_exact), check_test(layers_units_and_strangers_of_dxf),
           check_test(svg_comes_back_as_it_was), check_test(dxf_comes_back_with_its_layers),
           check_test(wrong_svg_is_refused), check_test(wrong_dxf_is_refused),
           check_test(ends_are_put_together_within_the_tolerance),
           check_test(what_is_drawn_twice_is_dropped), check_test(memory_failures_lose_nothing))
