"""The quasistatic method: from rest to rest along the motion that the mechanics gives."""
