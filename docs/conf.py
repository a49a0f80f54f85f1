"""Settings of the documentation site: Sphinx with Markdown pages, nothing fetched from the network.

`make docs` builds it into `build/docs`. The pages under `reference/generated` and `reference/api` are written from the
sources before the others are read, so they cannot lag behind. Those under `generated` are committed, for who reads the
pages where the repository is shown, and `tests/documentation/test_generated.py` compares them with the sources.
"""

import gc
import importlib
import inspect
import logging
import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
# A terminal's width would end up in the generated pages.
os.environ["COLUMNS"] = "100"

from generators import write_pages  # noqa: E402
from generators.api import module_names  # noqa: E402
from generators.docstrings import to_restructured_text  # noqa: E402
from sphinx.domains.python import PythonDomain  # noqa: E402
from sphinx.ext.autodoc.preserve_defaults import update_default_value  # noqa: E402
from sphinx.pycode.parser import Parser  # noqa: E402

# Nobody reads what Sphinx would say for debugging, or where in its file a definition ends; it has no setting for that.
logging.getLogger("sphinx").setLevel(logging.INFO)
Parser.parse_definition = lambda self: None
gc.set_threshold(50_000, 20, 50)

project = "SHER 3.0"
author = "the SHER3 authors"
language = "en"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["generators"]

# `## A heading` in one page is linked to as `page.md#a-heading` from another.
myst_heading_anchors = 4
myst_enable_extensions = ["deflist", "attrs_block"]
# A fence says `sh not-run: reason`, and the reader sees the reason; the colours are those of a shell all the same.
suppress_warnings = ["misc.highlighting_failure"]

# Signatures show annotations as they are written. Modules are imported, never run.
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_use_type_comments = False
smartquotes = False
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Class attributes", "params_style")]
add_module_names = False
# Objects in every page's menu are copied page by page: half of the build, for entries that the search finds.
toc_object_entries = False
python_use_unqualified_type_names = True
default_role = "code"

html_theme = "furo"
html_title = "SHER 3.0"
html_static_path = ["static"]
html_search_scorer = str(HERE / "search_order.js")
html_css_files = ["site.css"]
html_show_copyright = False
html_show_sourcelink = False
html_copy_source = False
# The theme's own switch of colours stays; no fonts, scripts or icons come from elsewhere.
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"


class ExactPythonDomain(PythonDomain):
    """Links a name in a signature to the object of exactly that name in reach, and never to one that ends like it.

    The search by endings looks through every object for every word of every signature: it takes most of the build, and
    finds strangers of the same name.
    """

    def find_obj(self, env, modname, classname, name, type, searchmode=0):
        """Return the objects of that name, without the search by endings."""
        return super().find_obj(env, modname, classname, name, type, 0)


def keep_defaults(app, thing, bound_method) -> None:
    """Show default values as they are written; only functions that have some are parsed for them."""
    plain = inspect.unwrap(getattr(thing, "__func__", thing))
    if inspect.isfunction(plain) and (plain.__defaults__ or plain.__kwdefaults__):
        update_default_value(thing, bound_method)


def prepare(app) -> None:
    """Write the pages, and import what they describe before Sphinx forks: else each of its processes would do it."""
    write_pages(HERE / "reference")
    for name in module_names():
        importlib.import_module(name)
    gc.freeze()


def skip_bound_methods(app, what, name, thing, skip, options) -> bool | None:
    """Leave out a method that a module names for short (`add = CATALOGUE.add`): it stands on its class's page."""
    return True if what == "module" and inspect.ismethod(thing) else None


def setup(app) -> None:
    """Write the generated pages, and let autodoc read docstrings that are plain text with Markdown's backticks."""
    app.add_domain(ExactPythonDomain, override=True)
    app.connect("builder-inited", prepare)
    app.connect("autodoc-before-process-signature", keep_defaults)
    app.connect("autodoc-skip-member", skip_bound_methods)
    # Before napoleon, which listens with priority 500 and expects reStructuredText.
    app.connect("autodoc-process-docstring", to_restructured_text, priority=100)
