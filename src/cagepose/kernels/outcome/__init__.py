"""From the case of a scene that is to be run to what is known of it afterwards: poses, events, contacts, proof."""
