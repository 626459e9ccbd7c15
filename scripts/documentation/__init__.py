"""Parts of scripts/docs_site."""
