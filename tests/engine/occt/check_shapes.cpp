// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Reads STEP files by OpenCASCADE, for tests/lua/step_spec.lua, and prints a line for each: whether
// the shape is valid, its volume and area in mm as integrated over the exact shape, and how many
// solids, planes, cylinders, cones and other faces it has.
//   check_shapes FILE...
#include <cstdio>

#include <BRepAdaptor_Surface.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

static void check(const char *path) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path) != IFSelect_RetDone) {
    std::printf("unreadable\n");
    return;
  }
  reader.TransferRoots();
  TopoDS_Shape shape = reader.OneShape();
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(shape, volume, 1e-12);
  BRepGProp::SurfaceProperties(shape, area, 1e-12);
  int solids = 0, kinds[4] = {0, 0, 0, 0};
  for (TopExp_Explorer at(shape, TopAbs_SOLID); at.More(); at.Next())
    solids++;
  for (TopExp_Explorer at(shape, TopAbs_FACE); at.More(); at.Next()) {
    GeomAbs_SurfaceType type = BRepAdaptor_Surface(TopoDS::Face(at.Current())).GetType();
    kinds[type == GeomAbs_Plane      ? 0
          : type == GeomAbs_Cylinder ? 1
          : type == GeomAbs_Cone     ? 2
                                     : 3]++;
  }
  std::printf("%s %.17g %.17g %d %d %d %d %d\n",
              BRepCheck_Analyzer(shape).IsValid() ? "valid" : "invalid", volume.Mass(), area.Mass(),
              solids, kinds[0], kinds[1], kinds[2], kinds[3]);
}

int main(int count, char **argument) {
  for (int i = 1; i < count; i++)
    check(argument[i]);
  return 0;
}
