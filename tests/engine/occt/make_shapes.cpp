// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Writes STEP and IGES files of shapes by OpenCASCADE, for tests/lua/cad_spec.lua, and prints of
// each file its name, and volume and area as OpenCASCADE integrates them, in the unit mm.
//   make_shapes FOLDER
#include <cstdio>
#include <string>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

static std::string folder;

static void tell(const std::string &name, const TopoDS_Shape &shape) {
  GProp_GProps volume, area;
  BRepGProp::VolumeProperties(shape, volume);
  BRepGProp::SurfaceProperties(shape, area);
  std::printf("%s %.17g %.17g\n", name.c_str(), volume.Mass(), area.Mass());
}

static void write_step(const std::string &name, const TopoDS_Shape &shape, const char *unit) {
  Interface_Static::SetCVal("write.step.unit", unit);
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write((folder + "/" + name).c_str());
  tell(name, shape);
}

static void write_iges(const std::string &name, const TopoDS_Shape &shape, const char *unit,
                       int solids) {
  IGESControl_Writer writer(unit, solids);
  writer.AddShape(shape);
  writer.ComputeModel();
  writer.Write((folder + "/" + name).c_str());
  tell(name, shape);
}

// Two bodies with names, one of them placed twice, and once mirrored.
static void write_assembly() {
  Interface_Static::SetCVal("write.step.unit", "MM");
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  Handle(XCAFDoc_ShapeTool) tool = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_Label block = tool->AddShape(BRepPrimAPI_MakeBox(10, 20, 30).Shape(), false);
  TDF_Label pin = tool->AddShape(BRepPrimAPI_MakeCylinder(3, 12).Shape(), false);
  TDF_Label all = tool->NewShape();
  TDataStd_Name::Set(block, "block");
  TDataStd_Name::Set(pin, "pin");
  TDataStd_Name::Set(all, "assembly");
  gp_Trsf aside, turned;
  aside.SetTranslation(gp_Vec(40, 0, 0));
  turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 1);
  turned.SetTranslationPart(gp_Vec(60, 5, 5));
  tool->AddComponent(all, block, TopLoc_Location());
  tool->AddComponent(all, pin, TopLoc_Location(aside));
  tool->AddComponent(all, pin, TopLoc_Location(turned));
  tool->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  writer.Transfer(document, STEPControl_AsIs);
  writer.Write((folder + "/assembly.step").c_str());
  tell("assembly.step", tool->GetShape(all));
}

int main(int count, char **argument) {
  if (count != 2)
    return 2;
  folder = argument[1];
  IGESControl_Controller::Init();
  TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-5, 2, 1), 40, 30, 20).Shape();
  TopoDS_Shape cylinder = BRepPrimAPI_MakeCylinder(8, 25).Shape();
  TopoDS_Shape sphere = BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 12).Shape();
  TopoDS_Shape torus = BRepPrimAPI_MakeTorus(20, 6).Shape();
  TopoDS_Shape cone = BRepPrimAPI_MakeCone(10, 0, 15).Shape();
  BRepFilletAPI_MakeFillet fillet(box);
  for (TopExp_Explorer at(box, TopAbs_EDGE); at.More(); at.Next())
    fillet.Add(3, TopoDS::Edge(at.Current()));
  TopoDS_Shape plate = BRepPrimAPI_MakeBox(60, 40, 5).Shape();
  for (int i = 0; i < 4; i++) {
    gp_Ax2 at(gp_Pnt(i % 2 ? 50 : 10, i / 2 ? 30 : 10, -1), gp_Dir(0, 0, 1));
    plate = BRepAlgoAPI_Cut(plate, BRepPrimAPI_MakeCylinder(at, 3 + i, 7).Shape());
  }
  TopoDS_Shape hollow = BRepAlgoAPI_Cut(box, BRepPrimAPI_MakeSphere(gp_Pnt(15, 17, 11), 7).Shape());
  gp_Trsf flip;
  flip.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)));
  TopoDS_Shape mirrored = BRepBuilderAPI_Transform(plate, flip, false).Shape();
  const struct {
    const char *name;
    TopoDS_Shape shape;
  } shapes[] = {{"box", box},     {"cylinder", cylinder}, {"sphere", sphere},
                {"torus", torus}, {"cone", cone},         {"fillet", fillet.Shape()},
                {"plate", plate}, {"hollow", hollow},     {"mirrored", mirrored}};
  const struct { const char *step, *iges; } units[] = {{"MM", "MM"}, {"INCH", "IN"}, {"M", "M"}};
  for (const auto &unit : units)
    for (const auto &one : shapes) {
      std::string name = std::string(one.name) + "_" + unit.step;
      write_step(name + ".step", one.shape, unit.step);
      write_iges(name + ".igs", one.shape, unit.iges, 0);
      write_iges(name + "_solid.iges", one.shape, unit.iges, 1);
    }
  write_step("curve.step", BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(10, 0, 0)).Edge(), "MM");
  write_assembly();
}
