"""HTML of models, paths, studies, landscapes and materials for notebooks.

Pictures stand on white and texts have the colour of the page, so that both can be read on light
and on dark backgrounds. Every text from a file is escaped.
"""

from flexor.notebook import landscapes, materials, models, paths, studies
from flexor.notebook.card import html

__all__ = ["html", "landscapes", "materials", "models", "paths", "studies"]
