// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The child's side: a file becomes shapes of OpenCASCADE, and these become triangles. Faces of a
// body share the polygons of their common edges, whose nodes are merged here by the topology, not
// by distance.
#include "occt/internal.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <istream>
#include <map>
#include <set>
#include <streambuf>
#include <string>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <NCollection_DataMap.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <Standard_Version.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include "barwright/occt.h"

namespace {

// The default tolerance over the diagonal of the box, and how far edges of loose faces may lie
// apart.
const double TOLERANCE = 5e-4, SEWING = 1e-5;

// What goes to the caller as a status.
struct failure {
  bw_status status;
  std::string text;
};

template <class value>
using by_shape = NCollection_DataMap<TopoDS_Shape, value, TopTools_ShapeMapHasher>;

struct body {
  TopoDS_Shape shape; // a solid, or an open shell
  std::string name;
};

struct file {
  double metres_per_unit = 1e-3;
  std::vector<body> bodies;
  std::vector<TopoDS_Face> loose; // faces of no solid
  std::string loose_name;
  by_shape<std::string> name; // of faces and solids, which are without their locations here
};

struct result {
  std::vector<double> point;
  std::vector<int32_t> triangle, group;
  std::vector<bwi_occt_body> body;
  std::vector<bwi_occt_face> face;
  std::vector<std::string> body_name, face_name;
};

// ---- reading ---------------------------------------------------------------------------------

class memory_buffer : public std::streambuf {
public:
  memory_buffer(const unsigned char *bytes, size_t count) {
    char *begin = const_cast<char *>(reinterpret_cast<const char *>(bytes));
    setg(begin, begin, begin + count);
  }

protected:
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    char *base = from == std::ios_base::beg   ? eback()
                 : from == std::ios_base::cur ? gptr()
                                              : egptr();
    setg(eback(), base + offset, egptr());
    return pos_type(gptr() - eback());
  }
  pos_type seekpos(pos_type place, std::ios_base::openmode which) override {
    return seekoff(off_type(place), std::ios_base::beg, which);
  }
};

double metres_of(TCollection_AsciiString name) {
  static const std::map<std::string, double> units = {
      {"millimetre", 1e-3}, {"millimeter", 1e-3}, {"mm", 1e-3},
      {"metre", 1},         {"meter", 1},         {"m", 1},
      {"centimetre", 1e-2}, {"cm", 1e-2},         {"decimetre", 0.1},
      {"micrometre", 1e-6}, {"kilometre", 1e3},   {"inch", 0.0254},
      {"in", 0.0254},       {"foot", 0.3048},     {"ft", 0.3048},
      {"mile", 1609.344},   {"mil", 2.54e-5},     {"microinch", 2.54e-8},
      {"nanometre", 1e-9}};
  name.LowerCase();
  auto found = units.find(name.ToCString());
  return found == units.end() ? 0 : found->second;
}

// By the flag of the global section of an IGES file.
double metres_of_flag(int flag) {
  static const double metres[] = {0, 0.0254, 1e-3,    0,    0.3048, 1609.344,
                                  1, 1e3,    2.54e-5, 1e-6, 1e-2,   2.54e-8};
  return flag > 0 && flag < 12 ? metres[flag] : 0;
}

std::string name_of(const TDF_Label &label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name))
    return "";
  return TCollection_AsciiString(name->Get()).ToCString();
}

// What the file calls faces and solids.
void find_names(file &read, const Handle(XSControl_WorkSession) & session) {
  Handle(Transfer_TransientProcess) transfer = session->TransferReader()->TransientProcess();
  Handle(Interface_InterfaceModel) model = session->Model();
  for (int i = 1; i <= model->NbEntities(); i++) {
    Handle(StepRepr_RepresentationItem) item =
        Handle(StepRepr_RepresentationItem)::DownCast(model->Value(i));
    if (item.IsNull() || item->Name().IsNull() || item->Name()->IsEmpty())
      continue;
    TopoDS_Shape shape = TransferBRep::ShapeResult(transfer, item);
    std::string name = item->Name()->ToCString();
    if (!shape.IsNull() && name != "NONE" &&
        (shape.ShapeType() == TopAbs_FACE || shape.ShapeType() == TopAbs_SOLID))
      read.name.Bind(shape.Located(TopLoc_Location()), name);
  }
}

std::string own_name(const file &read, const TopoDS_Shape &shape) {
  TopoDS_Shape key = shape.Located(TopLoc_Location());
  return read.name.IsBound(key) ? read.name.Find(key) : "";
}

// The solids and loose faces of a label and of what it is assembled from.
void walk(file &read, const TDF_Label &label, const TopLoc_Location &place) {
  TDF_LabelSequence parts;
  if (XCAFDoc_ShapeTool::IsAssembly(label) && XCAFDoc_ShapeTool::GetComponents(label, parts)) {
    for (int i = 1; i <= parts.Length(); i++) {
      TDF_Label referred;
      if (XCAFDoc_ShapeTool::GetReferredShape(parts.Value(i), referred))
        walk(read, referred, place * XCAFDoc_ShapeTool::GetLocation(parts.Value(i)));
    }
    return;
  }
  TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
  if (shape.IsNull())
    return;
  shape.Move(place);
  std::string label_name = name_of(label);
  std::vector<TopoDS_Shape> solids;
  for (TopExp_Explorer at(shape, TopAbs_SOLID); at.More(); at.Next())
    solids.push_back(at.Current());
  for (const TopoDS_Shape &solid : solids) {
    std::string own = own_name(read, solid);
    read.bodies.push_back({solid, own.empty() || solids.size() == 1 ? label_name : own});
  }
  for (TopExp_Explorer at(shape, TopAbs_FACE, TopAbs_SOLID); at.More(); at.Next()) {
    read.loose.push_back(TopoDS::Face(at.Current()));
    if (read.loose_name.empty())
      read.loose_name = label_name;
  }
}

void walk_document(file &read, const Handle(TDocStd_Document) & document) {
  TDF_LabelSequence free_shapes;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(free_shapes);
  for (int i = 1; i <= free_shapes.Length(); i++)
    walk(read, free_shapes.Value(i), TopLoc_Location());
}

void read_step(const bwi_occt_request &request, Handle(TDocStd_Document) & document, file &read) {
  STEPCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  memory_buffer buffer(request.bytes, request.count);
  std::istream stream(&buffer);
  if (reader.ChangeReader().ReadStream("file", stream) != IFSelect_RetDone)
    throw failure{BW_FORMAT, "the STEP file is damaged or cut off"};
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (lengths.Length() > 0 && metres_of(lengths.First()) > 0)
    read.metres_per_unit = metres_of(lengths.First());
  if (!reader.Transfer(document))
    throw failure{BW_GEOMETRY, "the STEP file holds no shape"};
  find_names(read, reader.Reader().WS());
  walk_document(read, document);
}

void read_iges(const bwi_occt_request &request, Handle(TDocStd_Document) & document, file &read) {
  // OpenCASCADE reads IGES from files only.
  int memory = memfd_create("barwright", 0);
  for (size_t done = 0; memory >= 0 && done < request.count;) {
    ssize_t written = write(memory, request.bytes + done, request.count - done);
    if (written <= 0)
      throw failure{BW_IO, "there is no room for a copy of the file"};
    done += size_t(written);
  }
  IGESCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  std::string path = "/proc/self/fd/" + std::to_string(memory);
  if (memory < 0 || reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw failure{BW_FORMAT, "the IGES file is damaged or cut off"};
  double metres = metres_of_flag(reader.IGESModel()->GlobalSection().UnitFlag());
  if (metres > 0)
    read.metres_per_unit = metres;
  if (!reader.Transfer(document))
    throw failure{BW_GEOMETRY, "the IGES file holds no shape"};
  walk_document(read, document);
}

double diagonal(const file &read) {
  Bnd_Box box;
  for (const body &one : read.bodies)
    BRepBndLib::Add(one.shape, box, false);
  for (const TopoDS_Face &face : read.loose)
    BRepBndLib::Add(face, box, false);
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

bool lies_in(const TopoDS_Solid &inner, const TopoDS_Solid &outer) {
  TopExp_Explorer vertex(inner, TopAbs_VERTEX);
  if (!vertex.More())
    return false;
  gp_Pnt at = BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()));
  Bnd_Box box;
  BRepBndLib::Add(outer, box, false);
  return !box.IsOut(at) &&
         BRepClass3d_SolidClassifier(outer, at, Precision::Confusion()).State() == TopAbs_IN;
}

// Solids without cavities, of which one in an odd number of others is a cavity of the innermost of
// these.
std::vector<TopoDS_Solid> with_cavities(const std::vector<TopoDS_Solid> &solids) {
  size_t count = solids.size();
  std::vector<std::vector<size_t>> around(count);
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j < count; j++)
      if (i != j && lies_in(solids[i], solids[j]))
        around[i].push_back(j);
  std::vector<TopoDS_Solid> whole(solids), out;
  for (size_t i = 0; i < count; i++) {
    if (around[i].size() % 2 == 0)
      continue;
    size_t owner = around[i][0];
    for (size_t j : around[i])
      if (around[j].size() > around[owner].size())
        owner = j;
    if (whole[owner].IsSame(solids[owner])) { // the given ones stay as they are
      TopoDS_Solid copy;
      BRep_Builder().MakeSolid(copy);
      for (TopoDS_Iterator at(solids[owner]); at.More(); at.Next())
        BRep_Builder().Add(copy, at.Value());
      whole[owner] = copy;
    }
    for (TopoDS_Iterator at(solids[i]); at.More(); at.Next())
      BRep_Builder().Add(whole[owner], at.Value().Reversed());
  }
  for (size_t i = 0; i < count; i++)
    if (around[i].size() % 2 == 0)
      out.push_back(whole[i]);
  return out;
}

// Loose faces that share edges become bodies: solids where they close, otherwise open shells.
void sew(file &read, double size) {
  if (read.loose.empty())
    return;
  BRepBuilderAPI_Sewing sewing(SEWING * size);
  for (const TopoDS_Face &face : read.loose)
    sewing.Add(face);
  sewing.Perform();
  for (const TopoDS_Face &face : read.loose) {
    TopoDS_Shape now = sewing.Modified(face);
    std::string name = own_name(read, face);
    if (!name.empty() && !now.IsNull())
      for (TopExp_Explorer at(now, TopAbs_FACE); at.More(); at.Next())
        read.name.Bind(at.Current().Located(TopLoc_Location()), name);
  }
  const TopoDS_Shape &sewn = sewing.SewedShape();
  if (sewn.IsNull())
    throw failure{BW_GEOMETRY, "its faces make no shell"};
  std::vector<TopoDS_Shell> shells;
  for (TopExp_Explorer at(sewn, TopAbs_SHELL); at.More(); at.Next())
    shells.push_back(TopoDS::Shell(at.Current()));
  for (TopExp_Explorer at(sewn, TopAbs_FACE, TopAbs_SHELL); at.More(); at.Next()) {
    TopoDS_Shell shell; // a sphere or torus is one face, which closes by itself
    BRep_Builder().MakeShell(shell);
    BRep_Builder().Add(shell, at.Current());
    shells.push_back(shell);
  }
  std::vector<TopoDS_Solid> solids;
  for (TopoDS_Shell &shell : shells) {
    if (!BRep_Tool::IsClosed(shell)) {
      read.bodies.push_back({shell, read.loose_name});
      continue;
    }
    shell.Closed(true);
    TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(shell);
    BRepLib::OrientClosedSolid(solid);
    solids.push_back(solid);
  }
  for (const TopoDS_Solid &solid : with_cavities(solids))
    read.bodies.push_back({solid, read.loose_name});
}

// ---- triangles -------------------------------------------------------------------------------

struct part { // a face with its triangulation
  TopoDS_Face face;
  Handle(Poly_Triangulation) mesh;
  TopLoc_Location place;
  int first; // of its nodes among those of the body
};

// Nodes of faces as disjoint sets; the representative is the first of its set.
class joined_nodes {
public:
  explicit joined_nodes(int count) : parent(size_t(count)) {
    for (int i = 0; i < count; i++)
      parent[size_t(i)] = i;
  }
  int root(int i) {
    while (parent[size_t(i)] != i)
      i = parent[size_t(i)] = parent[size_t(parent[size_t(i)])];
    return i;
  }
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent[size_t(std::max(a, b))] = std::min(a, b);
  }

private:
  std::vector<int> parent;
};

void join_vertex(joined_nodes &nodes, by_shape<int> &node_of, const TopoDS_Vertex &vertex,
                 int node) {
  if (vertex.IsNull())
    return;
  if (node_of.IsBound(vertex))
    nodes.join(node_of.Find(vertex), node);
  else
    node_of.Bind(vertex, node);
}

// Merges the nodes on the edges that faces have in common, on seams, and at the poles of faces.
void join_edges(joined_nodes &nodes, const std::vector<part> &parts) {
  by_shape<int> node_of;
  by_shape<std::vector<int>> nodes_of;
  for (const part &one : parts)
    for (TopExp_Explorer at(one.face, TopAbs_EDGE); at.More(); at.Next()) {
      const TopoDS_Edge &edge = TopoDS::Edge(at.Current());
      const Handle(Poly_PolygonOnTriangulation) &polygon =
          BRep_Tool::PolygonOnTriangulation(edge, one.mesh, one.place);
      if (polygon.IsNull())
        continue;
      std::vector<int> chain(size_t(polygon->NbNodes()));
      for (size_t i = 0; i < chain.size(); i++)
        chain[i] = one.first + polygon->Node(int(i) + 1) - 1;
      join_vertex(nodes, node_of, TopExp::FirstVertex(edge), chain.front());
      join_vertex(nodes, node_of, TopExp::LastVertex(edge), chain.back());
      if (BRep_Tool::Degenerated(edge)) {
        for (int node : chain)
          nodes.join(chain.front(), node);
        continue;
      }
      if (!nodes_of.IsBound(edge)) {
        nodes_of.Bind(edge, chain);
        continue;
      }
      const std::vector<int> &other = nodes_of.Find(edge);
      for (size_t i = 0; other.size() == chain.size() && i < chain.size(); i++)
        nodes.join(other[i], chain[i]);
    }
}

// The surface that carries a face, and its radius.
bw_cad_kind kind_of(const TopoDS_Face &face, double *radius) {
  BRepAdaptor_Surface surface(face, false);
  *radius = 0;
  switch (surface.GetType()) {
  case GeomAbs_Plane:
    return BW_CAD_PLANE;
  case GeomAbs_Cylinder:
    *radius = surface.Cylinder().Radius();
    return BW_CAD_CYLINDER;
  case GeomAbs_Cone:
    return BW_CAD_CONE;
  case GeomAbs_Sphere:
    *radius = surface.Sphere().Radius();
    return BW_CAD_SPHERE;
  case GeomAbs_Torus:
    *radius = surface.Torus().MinorRadius();
    return BW_CAD_TORUS;
  default:
    return BW_CAD_FREEFORM;
  }
}

std::string not_used(std::set<std::string> &used, const std::string &wanted,
                     const std::string &otherwise) {
  std::string base = wanted.empty() ? otherwise : wanted, name = base;
  for (int i = 2; !used.insert(name).second; i++)
    name = base + " " + std::to_string(i);
  return name;
}

class writer {
public:
  writer(const file &source, result &target) : read(source), out(target) {
  }

  void add(const body &one) {
    std::vector<part> parts;
    int count = 0;
    for (TopExp_Explorer at(one.shape, TopAbs_FACE); at.More(); at.Next()) {
      part next{TopoDS::Face(at.Current()), nullptr, TopLoc_Location(), count};
      next.mesh = BRep_Tool::Triangulation(next.face, next.place);
      if (next.mesh.IsNull() || next.mesh->NbTriangles() == 0)
        throw failure{BW_GEOMETRY, "face " + std::to_string(out.face.size() + parts.size() + 1) +
                                       " has a boundary that cannot be filled with triangles"};
      count += next.mesh->NbNodes();
      parts.push_back(next);
    }
    joined_nodes nodes(count);
    join_edges(nodes, parts);
    bwi_occt_body made = {};
    made.first_triangle = int64_t(out.group.size());
    std::vector<int32_t> number(size_t(count), -1);
    for (const part &next : parts) {
      add_triangles(next, nodes, number);
      made.area += add_face(next.face);
    }
    made.triangle_count = int64_t(out.group.size()) - made.first_triangle;
    made.closed = one.shape.ShapeType() == TopAbs_SOLID;
    if (made.closed) {
      GProp_GProps properties;
      BRepGProp::VolumeProperties(one.shape, properties);
      made.volume = properties.Mass();
    }
    if (made.volume < 0) { // it is inside out
      made.volume = -made.volume;
      for (size_t i = size_t(made.first_triangle); i < out.group.size(); i++)
        std::swap(out.triangle[3 * i + 1], out.triangle[3 * i + 2]);
    }
    out.body.push_back(made);
    out.body_name.push_back(
        not_used(body_names, one.name, "body " + std::to_string(out.body.size())));
  }

private:
  void add_triangles(const part &one, joined_nodes &nodes, std::vector<int32_t> &number) {
    const gp_Trsf &place = one.place.Transformation();
    bool turned = (one.face.Orientation() == TopAbs_REVERSED) != place.IsNegative();
    for (int i = 1; i <= one.mesh->NbTriangles(); i++) {
      int corner[3], root[3];
      one.mesh->Triangle(i).Get(corner[0], corner[1], corner[2]);
      if (turned)
        std::swap(corner[1], corner[2]);
      for (int k = 0; k < 3; k++)
        root[k] = nodes.root(one.first + corner[k] - 1);
      if (root[0] == root[1] || root[1] == root[2] || root[2] == root[0])
        continue; // at a pole
      for (int k = 0; k < 3; k++) {
        int32_t &point = number[size_t(root[k])];
        if (point < 0) {
          gp_Pnt at = one.mesh->Node(corner[k]).Transformed(place);
          point = int32_t(out.point.size() / 3);
          out.point.insert(out.point.end(), {at.X(), at.Y(), at.Z()});
        }
        out.triangle.push_back(point);
      }
      out.group.push_back(int32_t(out.face.size()));
    }
  }

  double add_face(const TopoDS_Face &face) {
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(face, properties);
    bwi_occt_face made = {};
    made.area = properties.Mass();
    made.kind = kind_of(face, &made.radius);
    made.body = int64_t(out.body.size());
    out.face.push_back(made);
    out.face_name.push_back(
        not_used(face_names, own_name(read, face), "face " + std::to_string(out.face.size())));
    return made.area;
  }

  const file &read;
  result &out;
  std::set<std::string> body_names, face_names;
};

// ---- the work --------------------------------------------------------------------------------

template <class item> void send(bw_job_stream *out, const std::vector<item> &list) {
  if (bw_job_write(out, list.data(), list.size() * sizeof(item)) != BW_OK)
    throw failure{BW_IO, "the starter of the process is gone"};
}

void send_result(bw_job_stream *out, const file &read, const result &made) {
  std::vector<char> names;
  for (const std::vector<std::string> *list : {&made.body_name, &made.face_name})
    for (const std::string &name : *list)
      names.insert(names.end(), name.c_str(), name.c_str() + name.size() + 1);
  std::vector<bwi_occt_head> head = {{int64_t(made.point.size() / 3), int64_t(made.group.size()),
                                      int64_t(made.body.size()), int64_t(made.face.size()),
                                      int64_t(names.size()), read.metres_per_unit}};
  send(out, head);
  send(out, made.point);
  send(out, made.triangle);
  send(out, made.group);
  send(out, made.body);
  send(out, made.face);
  send(out, names);
}

void work(const bwi_occt_request &request, bw_job_stream *out) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  file read;
  if (std::strcmp(bw_cad_format(request.bytes, request.count), "STEP") == 0)
    read_step(request, document, read);
  else
    read_iges(request, document, read);
  double size = diagonal(read);
  sew(read, size);
  if (read.bodies.empty())
    throw failure{BW_GEOMETRY, "it holds no solids and no faces, only curves or points or nothing"};
  // OpenCASCADE has millimetres by the unit of the file.
  double millimetre = 1e-3 * (request.unit > 0 ? request.unit / read.metres_per_unit : 1);
  double tolerance = request.tolerance > 0 ? request.tolerance / millimetre : TOLERANCE * size;
  result made;
  writer target(read, made);
  for (const body &one : read.bodies) {
    BRepMesh_IncrementalMesh(one.shape, tolerance, false, request.angle, false);
    target.add(one);
  }
  send_result(out, read, made);
}

} // namespace

const char *bw_occt_version(void) {
  return OCC_VERSION_COMPLETE;
}

bw_status bwi_occt_child(bw_context *context, void *data, bw_job_stream *out) {
  const bwi_occt_request *request = static_cast<const bwi_occt_request *>(data);
  try {
    work(*request, out);
    return BW_OK;
  } catch (const failure &what) {
    return bw_fail(context, what.status, "%s: %s", request->name, what.text.c_str());
  } catch (const std::bad_alloc &) {
    return BW_MEMORY;
  } catch (const Standard_Failure &what) {
    return bw_fail(context, BW_FORMAT, "%s: OpenCASCADE cannot read it (%s)", request->name,
                   what.DynamicType()->Name());
  } catch (const std::exception &what) {
    return bw_fail(context, BW_FORMAT, "%s: OpenCASCADE cannot read it (%s)", request->name,
                   what.what());
  }
}
