-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which page stands where in the site. Every page of docs/ must be named here, or lie in the folder `below` of an
-- entry: run.lua refuses to leave one out.
return {
  {title = "Tutorials", pages = {
    {"docs/tutorial.md", "From an STL file to an answer"}, {"docs/tutorial_geometry.md", "A part from numbers"},
    {"docs/tutorial_edit.md", "Edit sessions"},
    {"docs/tutorial_responsive.md", "From a drawing to a tuned bar"}, {"docs/tutorial_solids.md", "Soft bodies"},
    {"lessons", "Lessons"},
  }},
  {title = "Start", pages = {
    {"README.md", "Overview"}, {"docs/installation.md", "Installation"}, {"docs/validity.md", "Validity"},
    {"docs/faq.md", "Frequently asked questions"}, {"gallery", "Gallery"},
  }},
  {title = "How to", pages = {
    {"docs/howto_known_loads.md", "Compute a bracket"},
    {"docs/loads_and_supports.md", "Loads, supports, selections"},
    {"docs/choosing_a_solver.md", "Choose a solver"}, {"docs/import_export.md", "Import and export"},
    {"docs/howto_operators.md", "Matrices and operators of your own"},
    {"docs/howto_study.md", "Run a design study"}, {"docs/howto_experiments.md", "Publish an experiment"},
    {"docs/howto_cluster.md", "More than one machine"},
    {"docs/howto_scenarios.md", "Test a requirement"},
    {"docs/command_line.md", "Use the command line"}, {"docs/sandbox.md", "Run scripts of others"},
    {"docs/live.md", "Edit in the browser"}, {"docs/workbench.md", "Workbench"},
    {"docs/workbench_tasks.md", "Twelve tasks"}, {"docs/formats.md", "Formats"},
  }},
  {title = "Theory", pages = {
    {"docs/theory/elements.md", "Elements"}, {"docs/theory/filling.md", "Filling a surface"},
    {"docs/theory/faces.md", "Selections and faces"},
    {"docs/theory/singular.md", "Singular places"},
    {"docs/theory/solving.md", "Solving"}, {"docs/theory/preconditioners.md", "Preconditioners"},
    {"docs/theory/distributed.md", "Several processes"},
    {"docs/theory/worst_case.md", "Worst case"},
    {"docs/theory/breaking_force.md", "Breaking force"}, {"docs/theory/strengthen.md", "Strengthening"},
    {"docs/theory/error_control.md", "Error control"}, {"docs/theory/stability.md", "Linear buckling"},
    {"docs/theory/finite.md", "Large displacements"},
    {"docs/theory/heat.md", "Heat conduction"}, {"docs/theory/joints.md", "Joints"},
    {"docs/theory/symmetry.md", "Symmetry"},
    {"docs/theory/contact.md", "Contact"}, {"docs/theory/deposition.md", "Deposition"},
    {"docs/theory/dynamics.md", "Dynamics"},
    {"docs/theory/transient.md", "Motion in time"}, {"docs/theory/drop.md", "Drop"},
    {"docs/theory/edit.md", "Edit sessions"}, {"docs/theory/responsive.md", "The plane"},
    {"docs/theory/data_driven.md", "Soft bodies, coarsened"},
    {"docs/theory/studies.md", "Studies, scenarios, experiments"},
  }},
  {title = "Reference", pages = {
    {"docs/reference/index.md", "API", below = "docs/reference/*.md"}, {"docs/glossary.md", "Glossary"},
    {"docs/units.md", "Units"}, {"docs/bibliography.md", "Bibliography"},
    {"docs/stability.md", "Versions and stability"}, {"docs/third_party.md", "Third-party licences"},
    {"docs/verification.md", "Verification"},
    {"docs/benchmarks.md", "Benchmarks"}, {"docs/comparison.md", "Comparison with other tools"},
  }},
  {title = "Inside", pages = {
    {"docs/map.md", "Map of the source"}, {"CONTRIBUTING.md", "How to contribute"},
    {"docs/notes/index.md", "Notes", below = "docs/notes/*.md"},
  }},
}
