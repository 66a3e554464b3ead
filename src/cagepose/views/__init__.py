"""What people look at: pictures, plots and the page. Only this floor draws."""
