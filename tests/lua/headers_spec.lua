-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The comments of the public C headers are complete, and the check finds each kind of gap.
local check = require "check"
package.path = check.root .. "/scripts/docs/?.lua;" .. package.path
local header_gaps = require "header_gaps"
local headers = require "headers"

local context = header_gaps.context(check.root .. "/engine/include", check.root .. "/engine")

-- The gaps of a header that consists of a text, as "kind: text".
local function gaps_of(text)
  local header = headers.parse("/* test: a header. */\n\n" .. text)
  header_gaps.learn(context, header)
  local out = {}
  for i, gap in ipairs(header_gaps.of(context, header)) do out[i] = gap.kind .. ": " .. gap.text end
  return table.concat(out, "\n")
end

local COMPLETE = [[
/* How far `count` points are from a surface, after a paper: distance (m, count), the largest *peak (m) and the
 * corner (count) that is nearest. BW_GEOMETRY for an open surface. */
BW_API bw_status bw_surface_offsets(bw_context *context, const bw_surface *surface, int64_t count,
                                    const double *distance, double *peak, int32_t *corner);
/* A form of a thing. */
typedef enum bw_test_form {
  BW_TEST_ROUND, /* without corners */
  /* with corners */
  BW_TEST_SQUARE
} bw_test_form;
/* How bw_test works. */
typedef struct bw_test_options {
  double min[3], max[3]; /* default: everywhere */
  double size, *sizes;    /* (m, count) default 0: chosen; 0 or more */
  bw_test_form form;      /* default BW_TEST_ROUND */
} bw_test_options;
BW_API void bw_test_options_default(bw_test_options *options);
/* Sizes, owned by the caller. */
typedef struct bw_test_sizes {
  double *size; /* (m, 3) */
} bw_test_sizes;
/* An object that tests hold. */
typedef struct bw_test bw_test;
/* Mean size (m) of a test. */
BW_API double bw_test_size(const bw_test *test);
/* A word that lives as long as the test. */
BW_API const char *bw_test_label(const bw_test *test);
/* Largest number of tests. */
#define BW_TEST_MAX 3
]]

-- What the check says when a part of the complete header is replaced.
local broken = {
  {"/%* How far.-%*/\n", "", "comment: bw_surface_offsets: no comment"},
  {"distance %(m, count%)", "distance", "unit: bw_surface_offsets: distance: no unit\n"
    .. "shape: bw_surface_offsets: distance: no shape; *distance if it is one number"},
  {"distance %(m, count%)", "distance (count)", "unit: bw_surface_offsets: distance: no unit"},
  {"distance %(m, count%)", "distance (m)",
    "shape: bw_surface_offsets: distance: no shape; *distance if it is one number"},
  {"%*peak %(m%)", "height", "unit: bw_surface_offsets: peak: not mentioned"},
  {"corner %(count%)", "corner",
    "shape: bw_surface_offsets: corner: no shape; *corner if it is one number"},
  {"BW_GEOMETRY for an open surface", "",
    "status: bw_surface_offsets: returns BW_GEOMETRY; the comment does not say when"},
  {"BW_GEOMETRY for", "BW_GEOMETRY or BW_CONVERGENCE for",
    "status: bw_surface_offsets: nothing that it calls returns BW_CONVERGENCE"},
  {"bw_surface_offsets%(bw", "bw_surface_unknown(bw", "status: bw_surface_unknown: no definition found"},
  {"/%* without corners %*/", "", "comment: BW_TEST_ROUND: no comment"},
  {"/%* with corners %*/", "", "comment: BW_TEST_SQUARE: no comment"},
  {"/%* A form of a thing%. %*/", "", "comment: bw_test_form: no comment"},
  {"/%* How bw_test works%. %*/", "", "comment: bw_test_options: no comment"},
  {"/%* %(m, count%) default 0: chosen; 0 or more %*/", "",
    "comment: bw_test_options: size: no comment\ncomment: bw_test_options: sizes: no comment"},
  {"%(m, count%) default", "default", "unit: bw_test_options: size: its comment does not begin with a unit\n"
    .. "unit: bw_test_options: sizes: its comment does not begin with a unit\n"
    .. "shape: bw_test_options: sizes: its comment does not begin with unit and shape"},
  {"default 0: chosen", "", "default: bw_test_options: size: no default"},
  {"; 0 or more", "", "range: bw_test_options: size: no range"},
  {"/%* default BW_TEST_ROUND %*/", "/* its form */", "default: bw_test_options: form: no default"},
  {"/%* An object that tests hold%. %*/", "/* What tests hold. */",
    "ownership: bw_test: an object, or what releases it?"},
  {"Sizes, owned by the caller", "Sizes", "ownership: bw_test_sizes: size: who releases it?"},
  {"Mean size %(m%)", "Mean size", "unit: bw_test_size: no unit of its result"},
  {"lives as long as", "names", "ownership: bw_test_label: who releases its result?"},
  {"/%* Largest.-%*/\n", "", "comment: BW_TEST_MAX: no comment"},
}

describe("the C headers", function()
  for _, header in ipairs(context.headers) do
    it("have no gaps in " .. header.name, function()
      local list = header_gaps.of(context, header)
      local first = list[1] and ("line %d: %s: %s"):format(list[1].line, list[1].kind, list[1].text) or ""
      assert.equal(0, #list, ("scripts/check_headers %s lists them; %s"):format(header.name, first))
    end)
  end

  it("may be complete", function() assert.equal("", gaps_of(COMPLETE)) end)

  for _, case in ipairs(broken) do
    local pattern, replacement, expected = case[1], case[2], case[3]
    it("lack: " .. expected:match "^[^\n]*", function()
      local text, count = COMPLETE:gsub(pattern, replacement)
      assert.truthy(count > 0)
      assert.equal(expected, gaps_of(text))
    end)
  end
end)
