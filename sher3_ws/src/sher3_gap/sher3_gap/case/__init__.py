"""From bags to signals: the tick grid, known loads, and the checks that refuse data no answer could rest on."""
